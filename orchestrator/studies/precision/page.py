"""A precision study as a page: every run, the cheapest settings, errors over time and step."""

from __future__ import annotations

import math
from collections.abc import Callable

from ...report.page import Notes, Page, Section, Words
from ...report.plot import Axis, Curve, Figure, Plot
from ...report.table import Cell, Column, Table, quantity
from .study import MeasuredRun, Study
from .table import cheapest_settings, per_cycle

COLUMNS = [
    Column("Method"), Column("Step"), Column("Error", number=True), Column("Order", number=True),
    Column("Wall time", number=True), Column("doStep calls", number=True),
    Column("Rollbacks", number=True),
]  # fmt: skip


def page(study: Study) -> Page:
    """The cheapest settings on top, then the plots, then the runs."""
    errors = f"Errors of {', '.join(study.variables)} against {study.reference}."
    sections = [
        Section(
            "cheapest",
            "Cheapest for an error",
            [Words([errors]), Notes(list(cheapest_settings(study)))],
        ),
        Section("curves", "Error against cost", [_figure(study)]),
        Section("runs", "All runs", [_table(study)]),
    ]
    facts = [("Simulated", f"{study.simulated:.4g} s"), ("Runs", str(len(study.runs)))]
    return Page(f"Precision: {study.title}", errors, sections, facts)


def _table(study: Study) -> Table:
    return Table("Every method at every step", COLUMNS, [_row(study, r) for r in study.runs])


def _row(study: Study, measured: MeasuredRun) -> list[Cell]:
    first = [
        Cell(str(measured.method)),
        Cell(per_cycle(study, measured), measured.step),
    ]
    if measured.status != "done":
        return [
            *first,
            Cell("stopped", math.inf, "red", note=measured.status),
            *([Cell("")] * 4),
        ]
    error = study.error(measured)
    return [
        *first,
        quantity(error, f"{error:.2e}"),
        Cell("")
        if math.isnan(measured.order)
        else quantity(measured.order, f"{measured.order:.2f}"),
        quantity(measured.wall_time, f"{measured.wall_time:.3f} s"),
        quantity(measured.calls, str(measured.calls)),
        quantity(measured.rollbacks, str(measured.rollbacks)),
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


def _curves(study: Study, across: Callable[[MeasuredRun], float]) -> list[Curve]:
    curves = []
    for method in dict.fromkeys(measured.method for measured in study.runs):
        done = [r for r in study.runs if r.method == method and r.status == "done"]
        done = [r for r in done if study.error(r) > 0.0]
        if done:
            errors = [study.error(r) for r in done]
            curves.append(Curve(str(method), [across(r) for r in done], errors, "line-points"))
    return curves


def _wall_time(measured: MeasuredRun) -> float:
    return measured.wall_time


def _step(study: Study) -> Callable[[MeasuredRun], float]:
    return lambda measured: study.simulated / max(measured.steps, 1)
