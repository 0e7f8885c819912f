"""Table 1: five oscillators, their stiffness, frequency and displacement at resonance."""

from __future__ import annotations

import math

from ..pages.plot import Axis, Curve, Figure, Plot
from .item import Item, Row, row
from .job import plan_of
from .lab import Lab
from .measures import amplitude, lag
from .numbers import number
from .spectrum import Spectrum, Sweep, doubt, resolution, spectra

DEVICES = range(1, 6)
SHARES = (0.7, 0.8, 0.88, 0.92, 0.96, 1.0, 1.04, 1.08, 1.16, 1.3)
LARGEST, QUARTER = "largest amplitude", "90 degrees behind the drive"


def table1(lab: Lab) -> Item:
    """Sweeps about each predicted frequency."""
    sweeps = [
        Sweep(f"oscillator-{k}", [_rounded(share * _stated("predicted", k)) for share in SHARES])
        for k in DEVICES
    ]
    found = spectra(lab, sweeps, amplitude)
    rows: list[Row] = []
    errors: dict[str, list[float]] = {LARGEST: [], QUARTER: []}
    for k, spectrum in zip(DEVICES, found, strict=True):
        made = _rows(lab, k, spectrum)
        rows += made
        for reading, each in errors.items():
            each += [abs(r.error) for r in made if r.reading == reading and "measured" in r.key]
    spent = sum(spectrum.wall_time for spectrum in found)
    rows += [
        Row("table1.mean_error", sum(each) / len(each), reading, math.nan, "", spent)
        for reading, each in errors.items()
    ]
    words = (
        "The paper's own simplification: a linear spring with the printed stiffness, the printed"
        " mass, a V^2 force. What is left to a run is the height of the peak, and how far the"
        " loss moves it. Displacement is read as amplitude, as in figure 3.",
    )
    curves = [
        Curve(f"DEA {k}", s.frequencies, [1e3 * v for v in s.values(amplitude)], "line-points")
        for k, s in zip(DEVICES, found, strict=True)
    ]
    paper = Curve(
        *("paper", [_stated("measured", k) for k in DEVICES]),
        *([_stated("displacement", k) for k in DEVICES], "stated"),
    )
    plot = Plot(
        "Resonances", Axis("frequency (Hz)"), Axis("amplitude (mm)", least=0.0), [*curves, paper]
    )
    caption = "Amplitude about each resonance; points are measured frequency and displacement."
    figure = Figure("table1", "The five oscillators", caption, [plot])
    failures = [text for spectrum in found for text in spectrum.failures]
    return Item("table1", "Table 1: five oscillators", words, rows, [figure], failures)


def _rows(lab: Lab, k: int, spectrum: Spectrum) -> list[Row]:
    scene, spent = spectrum.sweep.scene, spectrum.wall_time
    starts = plan_of(spectrum.sweep.job(spectrum.frequencies[0]), lab.library).starts
    stiffness, mass = float(starts["spring"]["stiffness"]), float(starts["payload"]["mass"])
    plain = math.sqrt(stiffness / mass) / (2.0 * math.pi)
    rows = [
        Row(f"table1.stiffness_{k}", stiffness, scene=scene),
        Row(f"table1.predicted_{k}", plain, scene=scene),
    ]
    peak = spectrum.peak(amplitude)
    if peak is None:
        return rows
    wide = resolution(spectrum, peak)
    quarter = spectrum.crossing(lag, 0.5 * math.pi)
    measured = f"table1.measured_{k}"
    found = doubt(lab, spectrum, peak, amplitude)
    return [
        *rows,
        row(measured, quarter, scene, QUARTER),
        Row(measured, peak.at, LARGEST, wide, scene, spent),
        row(f"table1.displacement_{k}", found, scene),
    ]


def _stated(name: str, k: int) -> float:
    return float(number(f"table1.{name}_{k}").value)


def _rounded(frequency: float) -> float:
    return round(frequency, 2)
