"""Where the 20 Hz peak comes from: the third harmonic of a rectified drive, and the film's own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ....report.plot import Axis, Curve, Figure, Plot
from ....report.table import Cell, Column, Table, quantity
from ..cached_runs import CachedRuns
from ..comparison import Comparison
from ..figure3 import FIRST, SILICONE
from ..frequency_sweep import FrequencySweep, Sweep, frequency_sweeps
from ..job import Answer, Job
from ..metrics import amplitude, fourier
from ..published_values import given

TITLE = "Beyond: where the 20 Hz peak comes from"
MOST = 7
DRIVES = {"half-wave sine": "half_wave_sine", "raised sine": "raised_sine"}
MODELS = {"full membrane": "bench-silicone", "linear spring": "oscillator-1"}
KEPT = ("amplifier.*.voltage", "payload.displacement")


def superharmonic(cached_runs: CachedRuns) -> Comparison:
    """Two drives on two models over frequency; harmonics of drive and motion at the first peak."""
    cases = [(model, drive) for model in MODELS for drive in DRIVES]
    sweeps = [_sweep(MODELS[model], DRIVES[drive]) for model, drive in cases]
    found = dict(zip(cases, frequency_sweeps(cached_runs, sweeps, amplitude), strict=True))
    first = _first(found["full membrane", "half-wave sine"])
    failures = [text for each in found.values() for text in each.failures]
    if first is None:
        return Comparison("superharmonic", TITLE, (), (), [_spectra(found)], failures)
    frequency = round(first[0], 2)
    jobs = [_job(frequency, waveform) for waveform in DRIVES.values()]
    answers = cached_runs.answers(jobs)
    failures += [
        f"{j.scenario}: {a.reason}" for j, a in zip(jobs, answers, strict=True) if a.reason
    ]
    if failures:
        return Comparison("superharmonic", TITLE, (), (), [_spectra(found)], failures)
    sizes = {drive: _harmonics(a, frequency) for drive, a in zip(DRIVES, answers, strict=True)}
    push, motion = sizes["half-wave sine"]
    plain, _ = sizes["raised sine"]
    alone = _alone(cached_runs, frequency, math.sqrt(push[2] / plain[0]))
    own = sizes["raised sine"][1][2]
    words = (
        "Each electrode pulls with the square of its voltage, so what moves the spacer is"
        " V_top^2 - V_bottom^2. For two raised sines half a cycle apart that is a pure sine. For"
        " two half-wave sines it is sin t |sin t|, with a third harmonic of one fifth: a drive of"
        " a third of the resonance then pushes at the resonance. A linear spring has the peak under"
        " half-wave sines, at a third of its main one, and none under raised sines.",
        f"On the full membrane at {frequency:g} Hz the third harmonic of the motion is"
        f" {1e3 * motion[2]:.2f} mm, the fundamental {1e3 * motion[0]:.2f} mm. A raised sine at"
        f" {3 * frequency:.4g} Hz alone, its square scaled to the third harmonic of the drive,"
        f" moves the spacer by {1e3 * alone:.2f} mm, {100 * alone / motion[2]:.0f} % of it. A"
        f" raised sine at {frequency:g} Hz makes {1e3 * own:.2f} mm of it,"
        f" {100 * own / motion[2]:.0f} %, out of a drive with"
        f" {100 * plain[2] / plain[0]:.1f} % of third harmonic: that is the film's own"
        " nonlinearity, which gives raised sines a small peak too. The rest is"
        " neither alone: the two act on one another. So the peak is mostly the drive's, and its"
        " height says more of the amplifier's waveform than of the film.",
    )
    return Comparison(
        key="superharmonic",
        title=TITLE,
        words=words,
        rows=(),
        figures=[_spectra(found), _bars(sizes)],
        failures=failures,
        extras=[_table(found)],
    )


def _sweep(scenario: str, waveform: str) -> Sweep:
    own = {"bench-silicone": "half_wave_sine", "oscillator-1": "raised_sine"}[scenario]
    return Sweep(scenario, SILICONE, {} if waveform == own else {"amplifier.waveform": waveform})


def _job(frequency: float, waveform: str) -> Job:
    changes = {"amplifier.frequency": f"{frequency!r} Hz", "amplifier.waveform": waveform}
    return Job("superharmonic", changes, keep=KEPT, length=20, per_cycle=240, cycles=4)


def _alone(cached_runs: CachedRuns, frequency: float, share: float) -> float:
    """Amplitude [m] at three times the frequency, under a raised sine of a share of the voltage."""
    job = replace(_job(3.0 * frequency, "raised_sine"), length=60)
    changes = {**job.changes, "amplifier.amplitude": f"{share * float(given('drive')):.1f} V"}
    (answer,) = cached_runs.answers([replace(job, changes=changes)])
    return _harmonics(answer, 3.0 * frequency)[1][0] if answer.status == "done" else math.nan


def _harmonics(answer: Answer, frequency: float) -> tuple[list[float], list[float]]:
    """Amplitudes of the first harmonics of V_top^2 - V_bottom^2 [V^2] and of the motion [m]."""
    drive = answer.series("top.voltage") ** 2 - answer.series("bottom.voltage") ** 2
    span = 0.5 * float(answer.times[-1] - answer.times[0])
    found = [
        [abs(fourier(answer.times, each, k * frequency)) / span for k in range(1, MOST + 1)]
        for each in (drive, answer.series("displacement"))
    ]
    return found[0], found[1]


def _first(found: FrequencySweep) -> tuple[float, float] | None:
    tops = [peak for peak in found.maxima(amplitude) if peak.at < FIRST]
    top = max(tops, key=lambda peak: peak.value, default=None)
    return None if top is None else (top.at, top.value)


def _table(found: dict[tuple[str, str], FrequencySweep]) -> Table:
    rows = []
    for (model, drive), each in found.items():
        main, first = each.peak(amplitude, low=FIRST), _first(each)
        ratio = main.at / first[0] if main and first else math.nan
        rows.append(
            [
                Cell(model), Cell(drive),
                quantity(first[0], f"{first[0]:.2f} Hz") if first else Cell("none"),
                quantity(first[1], f"{1e3 * first[1]:.2f} mm") if first else Cell("-"),
                quantity(main.at, f"{main.at:.2f} Hz") if main else Cell("none"),
                quantity(ratio, f"{ratio:.3f}") if first else Cell("-"),
                Cell(each.sweep.scenario),
            ]
        )  # fmt: skip
    columns = [
        Column("Model"), Column("Drive"), Column("First peak", number=True),
        Column("Its amplitude", number=True), Column("Main peak", number=True),
        Column("Main over first", number=True), Column("Scenario"),
    ]  # fmt: skip
    return Table("Two drives on two models", columns, rows)


def _spectra(found: dict[tuple[str, str], FrequencySweep]) -> Figure:
    curves = [
        Curve(f"{model}, {drive}", each.frequencies,
              [1e3 * v for v in each.values(amplitude)], "line-points")
        for (model, drive), each in found.items()
    ]  # fmt: skip
    axes = (Axis("frequency (Hz)", least=0.0, most=100.0), Axis("amplitude (mm)", least=0.0))
    return Figure(
        "superharmonic-sweep",
        "Two drives on two models",
        "Half-wave sines bring a first peak on both; raised ones a small one on the membrane.",
        [Plot("Amplitude", *axes, curves)],
    )


def _bars(sizes: dict[str, tuple[list[float], list[float]]]) -> Figure:
    order = np.arange(1, MOST + 1).astype(float).tolist()
    across = Axis("harmonic", least=0.5, most=MOST + 0.5)
    plots = []
    for k, (title, label) in enumerate(
        (("Drive, V_top^2 - V_bottom^2", "of the fundamental"),
         ("Displacement", "of the fundamental"))
    ):  # fmt: skip
        curves = [
            Curve(drive, order, [v / each[k][0] for v in each[k]], "line-points")
            for drive, each in sizes.items()
        ]
        plots.append(Plot(title, across, Axis(label, least=0.0), curves))
    return Figure(
        "superharmonic", "Harmonics at the first peak",
        "Of the drive and of the motion, by their fundamentals; scenario superharmonic.", plots,
    )  # fmt: skip
