"""Figure 8: average mechanical power of 2, 4, 6 and 8 layers over frequency."""

from __future__ import annotations

import math

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import Lab
from .comparison import Item, Row
from .frequency_sweep import Spectrum, resolution
from .layer_sweeps import DEFINITION, LAYERS, once, payload_share, stacks
from .metrics import power
from .published_values import given, number

FAR, FAR_SHARE, NEAR_SHARE = 20.0, 0.1, 0.5
"""What 'very low' means: a tenth of the peak at 20 Hz, a half just below 35 Hz."""


def figure8(lab: Lab) -> Item:
    """Sweeps of the four stacks."""
    found = stacks(lab)
    rows: list[Row] = []
    for n, spectrum in zip(LAYERS, found, strict=True):
        peak = spectrum.peak(power)
        if peak is None:
            continue
        reading, spent = f"{n} layers", spectrum.wall_time
        wide = resolution(spectrum, peak)
        scene = spectrum.sweep.scene
        rows.append(Row("figure8.resonance", peak.at, reading, wide, scene, spent))
        rows.append(_low(spectrum, peak.value, reading))
    shares = [payload_share(lab, s) for s in found]
    curves = [
        Curve(f"{n} layers", s.frequencies, [1e3 * k * v for v in s.values(once)], "line-points")
        for n, s, k in zip(LAYERS, found, shares, strict=True)
    ]
    paper = Curve(
        *("paper, peaks of table 2", [float(number("figure8.resonance").value)] * len(LAYERS)),
        *([float(number(f"table2.power_{n}").value) for n in LAYERS], "stated"),
    )
    plot = Plot(
        *("Power", Axis("frequency (Hz)", least=0.0, most=100.0)),
        *(Axis("power, once a cycle (mW)", least=0.0), [*curves, paper]),
    )
    figure = Figure(
        "figure8", "Power over frequency", "Largest kinetic energy of the payload times f.", [plot]
    )
    failures = [text for spectrum in found for text in spectrum.failures]
    return Item(
        "figure8", "Figure 8: power over frequency", (DEFINITION,), rows, [figure], failures
    )


def _low(spectrum: Spectrum, top: float, reading: str) -> Row:
    """Power well below, and just below the frequency that the paper names, by the peak's."""
    edge = max(f for f in spectrum.frequencies if f < given("low_power_below"))
    far, near = spectrum.at(FAR, power) / top, spectrum.at(edge, power) / top
    said = f"{100 * far:.2g} % of the peak at {FAR:.0f} Hz, {100 * near:.2g} % at {edge:g} Hz"
    return Row(
        *("figure8.low", said, reading, math.nan, spectrum.sweep.scene, spectrum.wall_time),
        agrees=far < FAR_SHARE and near < NEAR_SHARE,
    )
