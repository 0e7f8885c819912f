"""Figure 3: amplitude and phase of the bench oscillator over frequency, silicone and VHB."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns
from .comparison import Comparison, Row, row
from .frequency_sweep import FrequencySweep, Sweep, doubt, frequency_sweeps, resolution
from .metrics import amplitude, lag
from .published_values import number

SILICONE = (1.0, 2.0, 3.0, 5.0, 7.0, *map(float, range(9, 30, 2)), 32.0, 35.0, 40.0, 44.0,
            *map(float, range(46, 66, 2)), 70.0, 75.0, 80.0, 90.0, 100.0)  # fmt: skip
VHB = (1.0, 2.0, *map(float, range(5, 50, 5)), 50.0, 52.0, 54.0, 60.0, 70.0, 80.0, 90.0, 100.0)
HALF = "half-wave sine (the scenario's)"
RAISED = "raised sine"
LIGHT = "half-wave sine, mass of DEA 1, 0.603 g"
FIRST = 35.0
"""Frequency [Hz] that parts the first peak from the main one."""


@dataclass(frozen=True)
class Reading:
    """One of the ways to understand how the specimen was driven, and what its film is."""

    name: str
    model: str
    found: FrequencySweep


def figure3(cached_runs: CachedRuns) -> Comparison:
    """Sweeps of both films, silicone in three readings of what the text leaves open."""
    sweeps = [
        Sweep("bench-silicone", SILICONE),
        Sweep("bench-silicone", SILICONE, {"amplifier.waveform": "raised_sine"}),
        Sweep("bench-silicone", SILICONE, {"payload.mass": "0.603 g"}),
        Sweep("bench-vhb", VHB),
    ]
    *silicone, vhb = frequency_sweeps(cached_runs, sweeps, amplitude)
    names = ((HALF, "scenario"), (RAISED, ""), (LIGHT, ""))
    readings = [Reading(*name, each) for name, each in zip(names, silicone, strict=True)]
    rows = [
        *_low(cached_runs, "figure3.low", readings, "bench-silicone"),
        *_first(cached_runs, readings),
        *_main(cached_runs, readings),
        *_low(cached_runs, "figure3.vhb_low", [Reading("", "", vhb)], "bench-vhb"),
        _falls(vhb),
        _quarter("figure3.vhb_quarter", Reading("", "", vhb), "bench-vhb"),
    ]
    words = (
        "Free displacement of the double cone with its spacer, b = 20 mm, L = 30 mm, 1920 V"
        " (VHB: 2500 V), as amplitude: half of peak to peak. Phase is that of the fundamental"
        " behind V_top^2 - V_bottom^2, of which the force is made.",
        "The text leaves open the waveform and the mass of the spacer. Two bipolar sines half a"
        " cycle apart would move nothing; of what moves something, the half-wave sine has a third"
        " harmonic in V^2, which gives the first peak. The mass of the scenario is that of 52 Hz by"
        " the paper's own formula; with that of DEA 1 the peak is at 62 Hz, since this cone is"
        " stiffer. So silicone stands here in three readings.",
        "The first peak stands at a third of the main one in every reading (see the section beyond"
        " the paper), so the paper's 20 and 52 Hz exclude one another by 15 % under any of them;"
        " the paper does not say which frequencies its sweep had.",
    )
    failures = [text for each in (*silicone, vhb) for text in each.failures]
    return Comparison(
        key="figure3",
        title="Figure 3: amplitude and phase of silicone and VHB",
        words=words,
        rows=rows,
        figures=[_drawn(readings, vhb)],
        failures=failures,
    )


def _low(
    cached_runs: CachedRuns, key: str, readings: Sequence[Reading], scenario: str
) -> list[Row]:
    return [
        row(
            key=key,
            found=cached_runs.measured(reading.found.sweep.job(1.0), amplitude),
            scenario=scenario,
            reading=reading.name,
            model=reading.model,
        )
        for reading in readings
    ]


def _first(cached_runs: CachedRuns, readings: Sequence[Reading]) -> list[Row]:
    """The largest peak below `FIRST`, where a reading has one."""
    rows: list[Row] = []
    for reading in readings:
        tops = [peak for peak in reading.found.maxima(amplitude) if peak.at < FIRST]
        if not tops:
            rows.append(Row("figure3.first_frequency", "none", reading.name, agrees=False))
            continue
        top = max(tops, key=lambda peak: peak.value)
        wide = resolution(reading.found, top)
        spent = reading.found.wall_time
        place = Row("figure3.first_frequency", top.at, reading.name, wide, "bench-silicone", spent)
        found = doubt(cached_runs, reading.found, top, amplitude)
        rows += [place, row("figure3.first_amplitude", found, "bench-silicone", reading.name)]
    return rows


def _main(cached_runs: CachedRuns, readings: Sequence[Reading]) -> list[Row]:
    """Place and height of the main peak, and where the displacement is a quarter behind."""
    rows: list[Row] = []
    for reading in readings:
        found = reading.found
        peak = found.peak(amplitude, low=FIRST)
        if peak is not None:
            wide, spent = resolution(found, peak), found.wall_time
            place = ("figure3.main_frequency", peak.at, reading.name, wide, "bench-silicone", spent)
            height = doubt(cached_runs, found, peak, amplitude)
            source = ("bench-silicone", reading.name, reading.model)
            rows += [
                Row(*place, model=reading.model),
                row("figure3.main_amplitude", height, *source),
            ]
        rows.append(_quarter("figure3.quarter", reading, "bench-silicone"))
    return rows


def _quarter(key: str, reading: Reading, scenario: str) -> Row:
    found = reading.found.crossing(lag, 0.5 * math.pi)
    return row(key, found, scenario, reading.name, reading.model)


def _falls(vhb: FrequencySweep) -> Row:
    tops = vhb.maxima(amplitude)
    peaks = ", ".join(f"{1e3 * top.value:.2f} mm at {top.at:.0f} Hz" for top in tops) or "none"
    return Row(
        key="figure3.vhb_falls",
        ours=peaks,
        reading="",
        doubt=math.nan,
        scenario="bench-vhb",
        wall_time=vhb.wall_time,
        agrees=not tops,
    )


def _drawn(readings: Sequence[Reading], vhb: FrequencySweep) -> Figure:
    sweeps = [*((f"silicone, {r.name}", r.found) for r in readings), ("VHB", vhb)]
    sizes = [
        Curve(name, s.frequencies, [1e3 * v for v in s.values(amplitude)], "line-points")
        for name, s in sweeps
    ]
    lags = [
        Curve(name, s.frequencies, [math.degrees(v) for v in s.values(lag)], "line-points")
        for name, s in sweeps
    ]
    places = [_stated(f"figure3.{name}") for name in ("first_frequency", "main_frequency")]
    heights = [_stated(f"figure3.{name}") for name in ("first_amplitude", "main_amplitude")]
    low = _stated("figure3.low")
    paper = Curve("paper, silicone", [1.0, *places], [low, *heights], "stated")
    quarter = Curve("paper, both", [_stated("figure3.quarter")], [90.0], "stated")
    across = Axis("frequency (Hz)", least=0.0, most=100.0)
    return Figure(
        "figure3",
        "Bench oscillator over frequency",
        "Amplitude (A) and phase (B). Points of the paper are those that its text states.",
        [
            Plot("A: amplitude", across, Axis("amplitude (mm)", least=0.0), [*sizes, paper]),
            Plot("B: phase", across, Axis("phase behind the drive (deg)"), [*lags, quarter]),
        ],
    )


def _stated(key: str) -> float:
    return float(number(key).value)
