"""What the electrodes' resistance and the amplifier's current limit cost."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ....report.plot import Axis, Curve, Figure, Plot
from ....report.table import Cell, Column, Table, quantity
from ..cached_runs import CachedRuns
from ..comparison import Comparison
from ..job import Answer, Job
from ..layer_sweeps import LAYERS
from ..metrics import amplitude, net, stroke

TITLE = "Beyond: resistance and current limit"
FREQUENCIES = (18, 46)
RESISTANCES = (1.0e4, 3.0e4, 1.0e5, 3.0e5, 1.0e6, 3.0e6)
LIMITS = (10.0e-3, 5.0e-3, 2.0e-3, 1.0e-3, 0.5e-3, 0.2e-3)
FREE = 1.0e3
"""Resistance [Ohm] that stands for none: RC below a thousandth of a cycle for eight layers."""

USUAL = 1.0e5
"""That of the scenarios [Ohm], assumed; the limit is looked at beside it."""

KEPT = ("amplifier.supplied_energy",)
VEHICLE = "vehicle"


def electrode(cached_runs: CachedRuns) -> Comparison:
    """Stacks of 2 to 8 layers under half-wave sines, and the vehicle under square waves."""
    cases = [*((f"{n} layers", f) for f in FREQUENCIES for n in LAYERS), (VEHICLE, 18)]
    ways = [("", 0.0), *(("R", r) for r in RESISTANCES), *(("I", i) for i in LIMITS)]
    jobs = [_job(name, f, *way) for name, f in cases for way in ways]
    answers = cached_runs.answers(jobs)
    failures = [f"{j.scenario}: {a.reason}" for j, a in zip(jobs, answers, strict=True) if a.reason]
    count = len(ways)
    found = {
        case: dict(zip(ways, answers[k * count : (k + 1) * count], strict=True))
        for k, case in enumerate(cases)
    }
    shares = {case: _shares(case, each) for case, each in found.items()}
    words = (
        "Amplitude of the stacks and stroke of the vehicle, by that with next to no resistance and"
        " no limit. Capacitance grows with layers, so at one resistance for all of them the time"
        " constant does too, and at one limit the voltage reached falls.",
        "Sines ask for a current of at most the capacitance times the voltage's slope; a square"
        " wave asks for an edge, so the vehicle is late by C V / I even where the mean current is"
        " small. 0.5 mA is what 1 W gives at 1920 V. The resistance of 0.1 MOhm is assumed in all"
        " scenarios, with table 2's droop in sight. Scenario electrode-limit has 1 MOhm and"
        " 0.5 mA at once.",
    )
    return Comparison(
        key="electrode",
        title=TITLE,
        words=words,
        rows=(),
        figures=[_drawn(shares)],
        failures=failures,
        extras=[_table(found, shares)],
    )


def _job(name: str, frequency: int, kind: str, value: float) -> Job:
    changes = {"amplifier.frequency": f"{frequency} Hz"}
    resistance = value if kind == "R" else USUAL if kind == "I" else FREE
    changes["amplifier.resistance"] = f"{resistance!r} Ohm"
    if kind == "I":
        changes["amplifier.current_limit"] = f"{value!r} A"
    return Job(_scenario(name), changes, keep=KEPT, length=40, per_cycle=120, cycles=4)


def _scenario(name: str) -> str:
    return "flapping-full-wings" if name == VEHICLE else f"power-{name.split()[0]}"


Way = tuple[str, float]


def _shares(case: tuple[str, int], each: dict[Way, Answer]) -> dict[Way, float]:
    """Amplitude, or stroke, by that of the ideal drive; NaN where a run stopped."""
    measure = stroke if case[0] == VEHICLE else amplitude
    values = {w: measure(a) if a.status == "done" else math.nan for w, a in each.items()}
    ideal = values["", 0.0]
    return {way: value / ideal for way, value in values.items()}


def _drawn(shares: dict[tuple[str, int], dict[Way, float]]) -> Figure:
    def curves(kind: str, values: Sequence[float], scale: float, frequency: int) -> list[Curve]:
        return [
            Curve(name, [scale * v for v in values], [each[kind, v] for v in values], "line-points")
            for (name, f), each in shares.items()
            if f == frequency
        ]

    share = Axis("of the ideal drive", least=0.0, most=1.1)
    plots = [
        plot
        for f in FREQUENCIES
        for plot in (
            Plot(f"{f} Hz: resistance", Axis("resistance of an electrode pair (MOhm)", log=True),
                 share, curves("R", RESISTANCES, 1e-6, f)),
            Plot(f"{f} Hz: current limit, 0.1 MOhm", Axis("limit of a channel (mA)", log=True),
                 share, curves("I", LIMITS, 1e3, f)),
        )
    ]  # fmt: skip
    return Figure(
        "electrode", "What resistance and limit cost",
        "Amplitude of stacks (half-wave sines) and stroke of the vehicle (square waves).", plots,
    )  # fmt: skip


def _table(
    found: dict[tuple[str, int], dict[Way, Answer]],
    shares: dict[tuple[str, int], dict[Way, float]],
) -> Table:
    shown: list[tuple[str, Way]] = [
        ("R = 0.1 MOhm", ("R", 1.0e5)), ("R = 1 MOhm", ("R", 1.0e6)),
        ("2 mA", ("I", 2.0e-3)), ("0.5 mA", ("I", 0.5e-3)),
    ]  # fmt: skip
    columns = [
        Column("Drive"), *(Column(name, number=True) for name, _ in shown),
        Column("Power drawn, R = 0.1 MOhm", number=True),
        Column("Power drawn, R = 1 MOhm", number=True),
        Column("Scenario"),
    ]  # fmt: skip
    rows = []
    for (name, f), each in found.items():
        row = [Cell(f"{name}, {f} Hz")]
        for _, way in shown:
            value = shares[name, f][way]
            row.append(quantity(value, f"{100 * value:.1f} %"))
        for resistance in (1.0e5, 1.0e6):
            answer = each["R", resistance]
            drawn = net(answer) if answer.status == "done" else math.nan
            row.append(quantity(drawn, f"{1e3 * drawn:.0f} mW"))
        rows.append([*row, Cell(_scenario(name))])
    return Table("Amplitude left, of that with an ideal drive; net power drawn", columns, rows)
