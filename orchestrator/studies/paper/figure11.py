"""Figure 11: flapping stroke over frequency without wings, with frames, with full wings."""

from __future__ import annotations

import math

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import Lab
from .comparison import Item, Row, row
from .frequency_sweep import Spectrum, Sweep, doubt, resolution, spectra
from .metrics import stroke
from .published_values import number

FREQUENCIES = (*map(float, range(1, 26)), *map(float, range(26, 41, 2)),
               45.0, 50.0)  # fmt: skip
CASES = {"no_wing": "no wings", "frames": "wing frames", "full_wings": "full wings"}


def flights(lab: Lab) -> list[Spectrum]:
    """The three sweeps, refined about the largest stroke; two seconds to settle."""
    names = [f"flapping-{case.replace('_', '-')}" for case in CASES]
    sweeps = [Sweep(name, FREQUENCIES, settle=2.0, cycles=5) for name in names]
    return spectra(lab, sweeps, stroke)


def figure11(lab: Lab) -> Item:
    """Places and heights of the three peaks."""
    found = flights(lab)
    rows: list[Row] = []
    for case, spectrum in zip(CASES, found, strict=True):
        peak = spectrum.peak(stroke)
        if peak is None:
            continue
        scene, wide = spectrum.sweep.scene, resolution(spectrum, peak)
        key, spent = f"figure11.{case}_frequency", spectrum.wall_time
        rows += [
            Row(key, peak.at, "", wide, scene, spent),
            row(f"figure11.{case}_stroke", doubt(lab, spectrum, peak, stroke), scene),
        ]
    words = (
        "Square waves of 1920 V half a cycle apart drive the eight-layer stack, here as a linear"
        " spring with a V^2 force. Five of the six numbers were used for calibration (see the"
        " marks); the stroke with full wings was not.",
    )
    curves = [
        Curve(name, s.frequencies, [math.degrees(v) for v in s.values(stroke)], "line-points")
        for name, s in zip(CASES.values(), found, strict=True)
    ]
    paper = Curve(
        *("paper, peaks", [_stated(f"{case}_frequency") for case in CASES]),
        *([_stated(f"{case}_stroke") for case in CASES], "stated"),
    )
    plot = Plot(
        *("Stroke", Axis("frequency (Hz)", least=0.0, most=50.0)),
        *(Axis("flapping stroke (deg)", least=0.0), [*curves, paper]),
    )
    figure = Figure("figure11", "Stroke over frequency", "Peak to peak, settled.", [plot])
    failures = [text for spectrum in found for text in spectrum.failures]
    return Item("figure11", "Figure 11: flapping stroke", words, rows, [figure], failures)


def _stated(name: str) -> float:
    return float(number(f"figure11.{name}").value)
