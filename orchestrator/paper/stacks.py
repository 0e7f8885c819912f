"""The four stacks of table 2 over frequency: what figures 8 and 9 and the table rest on."""

from __future__ import annotations

from .lab import Lab
from .measures import power
from .spectrum import Spectrum, Sweep, spectra

LAYERS = (2, 4, 6, 8)
FREQUENCIES = (1.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, *map(float, range(33, 61, 2)),
               65.0, 70.0, 80.0, 90.0, 100.0)  # fmt: skip
KEPT = ("payload.kinetic_energy", "amplifier.supplied_energy")

DEFINITION = (
    "Average mechanical power: the paper prints (1/T) int M x'' x' dt over a period T. That is the"
    " change of kinetic energy over a period, zero for any periodic motion, so the printed numbers"
    " are something else. Two readings: the mean of the positive part, 2 f E_max, which is what the"
    " mass is given in its half strokes (shown unless said otherwise), and the mean of the"
    " magnitude, twice as much."
)


def stacks(lab: Lab) -> list[Spectrum]:
    """Sweeps of all four, refined about the largest power."""
    return spectra(lab, [Sweep(f"power-{n}", FREQUENCIES, keep=KEPT) for n in LAYERS], power)
