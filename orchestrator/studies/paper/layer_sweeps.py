"""The four stacks of table 2 over frequency: what figures 8 and 9 and the table rest on."""

from __future__ import annotations

from .cached_runs import CachedRuns
from .frequency_sweep import FrequencySweep, Sweep, frequency_sweeps
from .job import Answer, plan_of
from .metrics import power

LAYERS = (2, 4, 6, 8)
FREQUENCIES = (1.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, *map(float, range(33, 61, 2)),
               65.0, 70.0, 80.0, 90.0, 100.0)  # fmt: skip
KEPT = ("payload.kinetic_energy", "amplifier.supplied_energy")

DEFINITION = (
    "Average mechanical power: the paper prints (1/T) int M x'' x' dt over a period T. That is the"
    " change of kinetic energy over a period, zero for any periodic motion, so the printed numbers"
    " are something else. Three readings: the largest kinetic energy once a cycle, f E_max; the"
    " mean of the positive part, 2 f E_max, since a cycle has two half strokes; the mean of the"
    " magnitude, 4 f E_max. The first is shown where no other is named: with the one film that"
    " table 1 and figure 3 ask for, it alone comes near the printed powers, and it alone goes with"
    " the stroke of 99 % that figure 9 states (64.5 mW at 45.8 Hz are strokes of 90, 63 and 45 %)."
    " M is the payload."
)
READINGS = (
    ("once a cycle", 0.5),
    ("mean of the positive part", 1.0),
    ("mean of the magnitude", 2.0),
)
"""What the power may mean, and how many times the mean of the positive part that is."""


def once(answer: Answer) -> float:
    """Largest kinetic energy of all that moves, once a cycle [W]."""
    return READINGS[0][1] * power(answer)


def payload_share(cached_runs: CachedRuns, frequency_sweep: FrequencySweep) -> float:
    """What of the moving mass is the payload, whose power the paper means."""
    start = plan_of(
        frequency_sweep.sweep.job(frequency_sweep.frequencies[0]), cached_runs.library
    ).starts["payload"]
    mass, film = (float(start.get(key, 0.0)) for key in ("mass", "film_mass"))
    return mass / (mass + film)


def stack(layers: int) -> Sweep:
    """How one of them is swept."""
    return Sweep(f"power-{layers}", FREQUENCIES, keep=KEPT)


def stacks(cached_runs: CachedRuns) -> list[FrequencySweep]:
    """Sweeps of all four, refined about the largest power."""
    return frequency_sweeps(cached_runs, [stack(n) for n in LAYERS], power)
