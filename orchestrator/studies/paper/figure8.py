"""Figure 8: average mechanical power of 2, 4, 6 and 8 layers over frequency."""

from __future__ import annotations

import math

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns
from .comparison import Comparison, Row
from .frequency_sweep import FrequencySweep, resolution
from .layer_sweeps import DEFINITION, LAYERS, once, payload_share, stacks
from .metrics import power
from .published_values import given, number

FAR, FAR_SHARE, NEAR_SHARE = 20.0, 0.1, 0.5
"""What 'very low' means: a tenth of the peak at 20 Hz, a half just below 35 Hz."""


def figure8(cached_runs: CachedRuns) -> Comparison:
    """Sweeps of the four stacks."""
    found = stacks(cached_runs)
    rows: list[Row] = []
    for n, frequency_sweep in zip(LAYERS, found, strict=True):
        peak = frequency_sweep.peak(power)
        if peak is None:
            continue
        reading, spent = f"{n} layers", frequency_sweep.wall_time
        wide = resolution(frequency_sweep, peak)
        scenario = frequency_sweep.sweep.scenario
        rows.append(Row("figure8.resonance", peak.at, reading, wide, scenario, spent))
        rows.append(_low(frequency_sweep, peak.value, reading))
    shares = [payload_share(cached_runs, s) for s in found]
    curves = [
        Curve(f"{n} layers", s.frequencies, [1e3 * k * v for v in s.values(once)], "line-points")
        for n, s, k in zip(LAYERS, found, shares, strict=True)
    ]
    paper = Curve(
        name="paper, peaks of table 2",
        x=[float(number("figure8.resonance").value)] * len(LAYERS),
        y=[float(number(f"table2.power_{n}").value) for n in LAYERS],
        style="stated",
    )
    plot = Plot(
        title="Power",
        x=Axis("frequency (Hz)", least=0.0, most=100.0),
        y=Axis("power, once a cycle (mW)", least=0.0),
        curves=[*curves, paper],
    )
    figure = Figure(
        "figure8", "Power over frequency", "Largest kinetic energy of the payload times f.", [plot]
    )
    failures = [text for frequency_sweep in found for text in frequency_sweep.failures]
    return Comparison(
        "figure8", "Figure 8: power over frequency", (DEFINITION,), rows, [figure], failures
    )


def _low(frequency_sweep: FrequencySweep, top: float, reading: str) -> Row:
    """Power well below, and just below the frequency that the paper names, by the peak's."""
    edge = max(f for f in frequency_sweep.frequencies if f < given("low_power_below"))
    far, near = frequency_sweep.at(FAR, power) / top, frequency_sweep.at(edge, power) / top
    shares = f"{100 * far:.2g} % of the peak at {FAR:.0f} Hz, {100 * near:.2g} % at {edge:g} Hz"
    return Row(
        key="figure8.low",
        ours=shares,
        reading=reading,
        doubt=math.nan,
        scenario=frequency_sweep.sweep.scenario,
        wall_time=frequency_sweep.wall_time,
        agrees=far < FAR_SHARE and near < NEAR_SHARE,
    )
