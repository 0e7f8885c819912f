"""Figure 11: flapping stroke over frequency without wings, with frames, with full wings."""

from __future__ import annotations

import math

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns
from .comparison import Comparison, Row, row
from .frequency_sweep import FrequencySweep, Sweep, doubt, frequency_sweeps, resolution
from .metrics import stroke
from .published_values import number

FREQUENCIES = (*map(float, range(1, 26)), *map(float, range(26, 41, 2)),
               45.0, 50.0)  # fmt: skip
CASES = {"no_wing": "no wings", "frames": "wing frames", "full_wings": "full wings"}


def flights(cached_runs: CachedRuns) -> list[FrequencySweep]:
    """The three sweeps, refined about the largest stroke; two seconds to settle."""
    names = [f"flapping-{case.replace('_', '-')}" for case in CASES]
    sweeps = [Sweep(name, FREQUENCIES, settle=2.0, cycles=5) for name in names]
    return frequency_sweeps(cached_runs, sweeps, stroke)


def figure11(cached_runs: CachedRuns) -> Comparison:
    """Places and heights of the three peaks."""
    found = flights(cached_runs)
    rows: list[Row] = []
    for case, frequency_sweep in zip(CASES, found, strict=True):
        peak = frequency_sweep.peak(stroke)
        if peak is None:
            continue
        scenario, wide = frequency_sweep.sweep.scenario, resolution(frequency_sweep, peak)
        key, spent = f"figure11.{case}_frequency", frequency_sweep.wall_time
        rows += [
            Row(key, peak.at, "", wide, scenario, spent),
            row(
                f"figure11.{case}_stroke",
                doubt(cached_runs, frequency_sweep, peak, stroke),
                scenario,
            ),
        ]
    words = (
        "Square waves of 1920 V half a cycle apart drive the eight-layer stack: the film of the"
        " bench, with dry friction in the mechanism. Five of the six numbers were used for"
        " calibration (see the marks); the stroke with full wings was not.",
    )
    curves = [
        Curve(name, s.frequencies, [math.degrees(v) for v in s.values(stroke)], "line-points")
        for name, s in zip(CASES.values(), found, strict=True)
    ]
    paper = Curve(
        name="paper, peaks",
        x=[_stated(f"{case}_frequency") for case in CASES],
        y=[_stated(f"{case}_stroke") for case in CASES],
        style="stated",
    )
    plot = Plot(
        title="Stroke",
        x=Axis("frequency (Hz)", least=0.0, most=50.0),
        y=Axis("flapping stroke (deg)", least=0.0),
        curves=[*curves, paper],
    )
    figure = Figure("figure11", "Stroke over frequency", "Peak to peak, settled.", [plot])
    failures = [text for frequency_sweep in found for text in frequency_sweep.failures]
    return Comparison("figure11", "Figure 11: flapping stroke", words, rows, [figure], failures)


def _stated(name: str) -> float:
    return float(number(f"figure11.{name}").value)
