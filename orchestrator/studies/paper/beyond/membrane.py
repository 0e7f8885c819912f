"""The full membrane against the linear spring: where they agree, where not, what it costs."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ....report.plot import Axis, Curve, Figure, Plot
from ....report.table import Cell, Column, Table, quantity
from ..cached_runs import CachedRuns
from ..comparison import Comparison
from ..figure11 import flights
from ..frequency_sweep import FrequencySweep, Measure, Sweep, frequency_sweeps
from ..metrics import amplitude, stroke
from ..published_values import number
from ..table1 import oscillators

FREQUENCIES = (1.0, 4.0, 8.0, 12.0, *map(float, range(14, 25)), 26.0, 28.0, 32.0, 36.0, 40.0)
VEHICLE = {
    "long rocker, full membrane": "flapping-long-rocker-full-wings",
    "linear spring, 0.098 N": "flapping-spring-full-wings",
}
"""What stands beside the vehicle of the figures; each with its own fitted mechanism."""

TITLE = "Beyond: full membrane against linear spring"


def membrane(cached_runs: CachedRuns) -> Comparison:
    """First oscillator and vehicle by both, and the time of a step of each."""
    sweeps = [Sweep(name, FREQUENCIES, settle=2.0, cycles=5) for name in VEHICLE.values()]
    flown = frequency_sweeps(cached_runs, sweeps, stroke)
    film, spring = (each[0] for each in oscillators(cached_runs).values())
    vehicle = [("full membrane", flights(cached_runs)[-1]), *zip(VEHICLE, flown, strict=True)]
    bench = [("linear spring", spring), ("full membrane", film)]
    words = (
        "On a payload the two differ little near resonance, where the spring's stiffness is printed"
        " and its force and loss are fitted: the membrane softens with voltage and amplitude, and"
        " its loss stiffens it.",
        "In the vehicle they differ by the force, and by what takes it away. The film of tables 1"
        " and 2 and figure 3 flies it where the mechanism loses a quarter of a newton to dry"
        " friction; a spring with 0.098 N, less than a third of the film's force, does so with"
        " viscous losses alone; another reading of the links asks for a fifth of a newton. All"
        " three meet the five fitted numbers of figure 11. They part at low frequencies, where the"
        " paper gives no stroke: see the lowest frequency of each. The time of a step is that of"
        " whole runs, loading and evaluation included.",
    )
    rows = [_row(f"DEA 1, {name}", each, amplitude, 1e3, "mm") for name, each in bench]
    rows += [
        _row(f"full wings, {name}", each, stroke, math.degrees(1.0), "deg")
        for name, each in vehicle
    ]
    columns = [
        Column("Model"), Column("Peak at", number=True), Column("Peak", number=True),
        Column("Lowest frequency", number=True), Column("Time of a step", number=True),
        Column("Scenario"),
    ]  # fmt: skip
    failures = [text for _, each in (*bench, *vehicle) for text in each.failures]
    return Comparison(
        key="membrane",
        title=TITLE,
        words=words,
        rows=(),
        figures=[_drawn(bench, vehicle)],
        failures=failures,
        extras=[Table("Full membrane and linear spring", columns, rows)],
    )


def _row(name: str, found: FrequencySweep, measure: Measure, scale: float, unit: str) -> list[Cell]:
    peak = found.peak(measure)
    done = [answer for answer in found.answers.values() if answer.status == "done"]
    steps = sum(answer.steps for answer in done)
    pace = 1e6 * sum(answer.wall_time for answer in done) / steps if steps else math.nan
    lowest = scale * found.values(measure)[0]
    first = found.frequencies[0]
    return [
        Cell(name),
        quantity(peak.at, f"{peak.at:.1f} Hz") if peak else Cell("none"),
        quantity(scale * peak.value, f"{scale * peak.value:.3g} {unit}") if peak else Cell("-"),
        quantity(lowest, f"{lowest:.3g} {unit} at {first:.3g} Hz"),
        quantity(pace, f"{pace:.0f} us"),
        Cell(found.sweep.scenario),
    ]


def _drawn(
    bench: Sequence[tuple[str, FrequencySweep]], vehicle: Sequence[tuple[str, FrequencySweep]]
) -> Figure:
    across = Axis("frequency (Hz)")
    sizes = [
        Curve(name, s.frequencies, [1e3 * v for v in s.values(amplitude)], "line-points")
        for name, s in bench
    ]
    sizes.append(
        Curve(
            name="paper",
            x=[_stated("table1.measured_1")],
            y=[_stated("table1.displacement_1")],
            style="stated",
        )
    )
    strokes = [
        Curve(name, s.frequencies, [math.degrees(v) for v in s.values(stroke)], "line-points")
        for name, s in vehicle
    ]
    at, top = (_stated(f"figure11.full_wings_{each}") for each in ("frequency", "stroke"))
    strokes.append(Curve("paper", [at], [top], "stated"))
    return Figure(
        "membrane",
        "One motion, two models",
        "Left the first oscillator of table 1, right the vehicle with full wings.",
        [
            Plot("DEA 1", across, Axis("amplitude (mm)", least=0.0), sizes),
            Plot("Full wings", across, Axis("flapping stroke (deg)", least=0.0), strokes),
        ],
    )


def _stated(key: str) -> float:
    return float(number(key).value)
