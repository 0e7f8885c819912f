"""A precision study as a page: every rung, what is advised, errors over time and step."""

from __future__ import annotations

import math
from collections.abc import Callable

from ...report.page import Notes, Page, Section, Words
from ...report.plot import Axis, Curve, Figure, Plot
from ...report.table import Cell, Column, Table, quantity
from .study import Rung, Study
from .table import advice, per_cycle

COLUMNS = [
    Column("Method"), Column("Step"), Column("Error", number=True), Column("Order", number=True),
    Column("Wall time", number=True), Column("doStep calls", number=True),
    Column("Rollbacks", number=True),
]  # fmt: skip


def page(study: Study) -> Page:
    """Advice on top, then the plots, then the rungs."""
    errors = f"Errors of {', '.join(study.variables)} against {study.reference}."
    sections = [
        Section("advice", "Cheapest for an error", [Words([errors]), Notes(list(advice(study)))]),
        Section("curves", "Error against cost", [_figure(study)]),
        Section("rungs", "All runs", [_table(study)]),
    ]
    facts = [("Simulated", f"{study.simulated:.4g} s"), ("Runs", str(len(study.rungs)))]
    return Page(f"Precision: {study.title}", errors, sections, facts)


def _table(study: Study) -> Table:
    return Table("Every method at every step", COLUMNS, [_row(study, r) for r in study.rungs])


def _row(study: Study, rung: Rung) -> list[Cell]:
    first = [Cell(str(rung.method)), Cell(per_cycle(study, rung), rung.step)]
    if rung.status != "done":
        return [*first, Cell("stopped", math.inf, "red", note=rung.status), *([Cell("")] * 4)]
    error = study.error(rung)
    return [
        *first,
        quantity(error, f"{error:.2e}"),
        Cell("") if math.isnan(rung.order) else quantity(rung.order, f"{rung.order:.2f}"),
        quantity(rung.wall_time, f"{rung.wall_time:.3f} s"),
        quantity(rung.calls, str(rung.calls)),
        quantity(rung.rollbacks, str(rung.rollbacks)),
    ]


def _figure(study: Study) -> Figure:
    error = Axis("largest relative error", log=True)
    plots = [
        Plot(title, Axis(label, log=True), error, _curves(study, across))
        for title, label, across in (
            ("Error over wall time", "wall time (s)", _wall_time),
            ("Error over step", "mean communication step (s)", _step(study)),
        )
    ]
    return Figure("precision", "Error against cost", "A curve for each method.", plots)


def _curves(study: Study, across: Callable[[Rung], float]) -> list[Curve]:
    curves = []
    for method in dict.fromkeys(rung.method for rung in study.rungs):
        done = [r for r in study.rungs if r.method == method and r.status == "done"]
        done = [r for r in done if study.error(r) > 0.0]
        if done:
            errors = [study.error(r) for r in done]
            curves.append(Curve(str(method), [across(r) for r in done], errors, "line-points"))
    return curves


def _wall_time(rung: Rung) -> float:
    return rung.wall_time


def _step(study: Study) -> Callable[[Rung], float]:
    return lambda rung: study.simulated / max(rung.steps, 1)
