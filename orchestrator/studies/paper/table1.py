"""Table 1: five oscillators, their stiffness, frequency and displacement at resonance."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import Lab
from .comparison import Item, Row, row
from .frequency_sweep import Spectrum, Sweep, doubt, resolution, spectra
from .job import plan_of
from .metrics import amplitude, lag
from .published_values import number

DEVICES = range(1, 6)
SHARES = (0.7, 0.8, 0.88, 0.92, 0.96, 1.0, 1.04, 1.08, 1.16, 1.3)
DISPLACEMENTS = (
    "Displacements are missed by up to 17 %, and no number of the film mends that: by the fit's"
    " sensitivities (resilin calibrate material) 1 % of permittivity moves DEA 1 by +1.24 % and"
    " DEA 5 by +1.16 %, 1 % of loss factor by -1.22 and -1.17 %. Layers cancel out of the"
    " amplitude, yet the paper's two layers move 8.12 mm at 51 Hz where its one moves 7.2 at 52."
    " DEA 4 would want an eighth less loss at 28 Hz than DEA 3 has at 26."
)
LARGEST, QUARTER = "largest amplitude", "90 degrees behind the drive"


@dataclass(frozen=True)
class Model:
    """One way to compute the oscillators: its key for marks, words, and scenes."""

    key: str
    words: str
    scene: str


FILM = Model("film", "full membrane", "dea-{}")
SPRING = Model("spring", "linear spring", "oscillator-{}")


def oscillators(lab: Lab) -> dict[Model, list[Spectrum]]:
    """Sweeps about each predicted frequency, by the full membrane and by the spring."""
    models = (FILM, SPRING)
    sweeps = [Sweep(model.scene.format(k), _about(k)) for model in models for k in DEVICES]
    every = spectra(lab, sweeps, amplitude)
    count = len(DEVICES)
    return {model: every[k * count : (k + 1) * count] for k, model in enumerate(models)}


def table1(lab: Lab) -> Item:
    """Frequencies and displacements of the five, by both models."""
    found = oscillators(lab)
    every = [spectrum for each in found.values() for spectrum in each]
    rows = [row for model, each in found.items() for row in _of_model(lab, model, each)]
    words = (
        "Two models. The full membrane is that of figures 3, 8 and 9, with one set of numbers for"
        " all of them: constants and thickness printed, spacers of 20 mm (DEA 4: 13.25) inferred"
        " from the printed stiffness, permittivity, loss factor and moving mass of a layer"
        " calibrated. Voltage and amplitude soften it, its loss stiffens it with frequency, and at"
        " these resonances the two nearly cancel: that is why the paper's formula fits.",
        "The linear spring is the paper's own simplification with the printed stiffness and mass;"
        " what is left to a run is the height of the peak, and how far the loss moves it."
        " Displacement is read as amplitude, as in figure 3.",
        DISPLACEMENTS,
    )
    failures = [text for spectrum in every for text in spectrum.failures]
    return Item("table1", "Table 1: five oscillators", words, rows, [_drawn(found)], failures)


def _of_model(lab: Lab, model: Model, found: Sequence[Spectrum]) -> Iterator[Row]:
    errors: dict[str, list[float]] = {LARGEST: [], QUARTER: []}
    for k, spectrum in zip(DEVICES, found, strict=True):
        made = list(_rows(lab, k, model, spectrum))
        yield from made
        for reading, each in errors.items():
            each += [abs(r.error) for r in made if reading in r.reading and "measured" in r.key]
    spent = sum(spectrum.wall_time for spectrum in found)
    for reading, each in errors.items():
        mean = sum(each) / len(each) if each else math.nan
        told = f"{model.words}, {reading}"
        yield Row("table1.mean_error", mean, told, math.nan, "", spent, model=model.key)


def _rows(lab: Lab, k: int, model: Model, spectrum: Spectrum) -> Iterator[Row]:
    scene, spent = spectrum.sweep.scene, spectrum.wall_time
    if model is SPRING:
        starts = plan_of(spectrum.sweep.job(spectrum.frequencies[0]), lab.library).starts
        stiffness, mass = float(starts["spring"]["stiffness"]), float(starts["payload"]["mass"])
        yield Row(f"table1.stiffness_{k}", stiffness, scene=scene)
        plain = math.sqrt(stiffness / mass) / (2.0 * math.pi)
        yield Row(f"table1.predicted_{k}", plain, scene=scene)
    peak = spectrum.peak(amplitude)
    if peak is None:
        return
    measured = f"table1.measured_{k}"
    wide = resolution(spectrum, peak)
    told = f"{model.words}, {LARGEST}"
    yield Row(measured, peak.at, told, wide, scene, spent, model=model.key)
    quarter = spectrum.crossing(lag, 0.5 * math.pi)
    yield row(measured, quarter, scene, f"{model.words}, {QUARTER}", model.key)
    height = doubt(lab, spectrum, peak, amplitude)
    yield row(f"table1.displacement_{k}", height, scene, model.words, model.key)


def _drawn(found: dict[Model, list[Spectrum]]) -> Figure:
    curves = [
        Curve(
            f"DEA {k}, {model.words}", s.frequencies, [1e3 * v for v in s.values(amplitude)],
            "line-points" if model is FILM else "dashed",
        )
        for model, each in found.items()
        for k, s in zip(DEVICES, each, strict=True)
    ]  # fmt: skip
    paper = Curve(
        *("paper", [_stated("measured", k) for k in DEVICES]),
        *([_stated("displacement", k) for k in DEVICES], "stated"),
    )
    plot = Plot(
        "Resonances", Axis("frequency (Hz)"), Axis("amplitude (mm)", least=0.0), [*curves, paper]
    )
    caption = "Amplitude about each resonance; points are measured frequency and displacement."
    return Figure("table1", "The five oscillators", caption, [plot])


def _stated(name: str, k: int) -> float:
    return float(number(f"table1.{name}_{k}").value)


def _about(k: int) -> list[float]:
    return [round(share * _stated("predicted", k), 2) for share in SHARES]
