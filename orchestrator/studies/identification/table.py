"""A fit as tables, remarks, a figure, and data for scripts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import printable
from ...report.page import Notes, Page, Section
from ...report.plot import Axis, Curve, Figure, Plot
from ...report.table import Cell, Column, quantity
from ...report.table import Table as PageTable
from ...report.whole_names import keep_whole
from .study import Identified

if TYPE_CHECKING:
    from rich.table import Table

DRAWN = 1500
"""Points of a curve in a plot, at most about."""
ALIKE = 0.99
"""Correlation above which two parameters cannot be distinguished."""
NOTABLE = 0.1
"""Stepping error, relative to the residuals' size, above which there is a remark."""


def parameters(found: Identified) -> Table:
    """Each parameter: start value, fitted value, interval."""
    from rich.table import Table

    made = Table(title=printable(found.case.plan.scenario.title), title_justify="left")
    for label in ("parameter", "start", "fitted", f"interval, {100 * found.level:g} %", "unit"):
        made.add_column(label, justify="left" if label in {"parameter", "unit"} else "right")
    for k, unknown in enumerate(found.unknowns):
        made.add_row(
            printable(unknown.full), f"{unknown.start:.6g}", f"{found.values[k]:.6g}",
            f"+- {found.intervals[k]:.2g}", unknown.unit,
        )  # fmt: skip
    return keep_whole(made, 0)


def outputs(found: Identified) -> Table:
    """Each output: residual, explained share, correlation of neighbours, stepping error."""
    from rich.table import Table

    made = Table("output", "residual, rms", "explained", "neighbours", "stepping error")
    for k, (_, own) in enumerate(found.case.pairs):
        unit = found.case.units[k]
        made.add_row(
            printable(own), f"{found.sizes[k]:.3g} {unit}", f"{100 * found.shares[k]:.3f} %",
            f"{found.lag_one[k]:+.2f}", f"{found.stepping[k]:.2g} {unit}",
        )  # fmt: skip
    return keep_whole(made, 0)


def objections(found: Identified) -> Iterator[str]:
    """Reasons for which the fitted values are no result, a line each."""
    for k, (_, own) in enumerate(found.case.pairs):
        if found.coarse[k]:
            yield (
                f"not a result: half the communication step moves {own} by"
                f" {found.stepping[k]:.2g} {found.case.units[k]}, the step decides these values;"
                " take more rows or a smaller --step"
            )
        if found.missed[k]:
            yield (
                f"not a result: the parts explain {100 * found.shares[k]:.0f} % of {own}, and"
                " noise is not the reason; do not rely on these values: look at the parts, their"
                " other parameters and the start values"
            )


def remarks(found: Identified) -> Iterator[str]:
    """Reasons against taking the numbers as they are, beside :func:`objections`."""
    for name in found.at_bounds:
        yield (
            f"{name} has gone to the end of its range: the best value is beyond, or the data do not"
            " determine it"
        )
    for k, unknown in enumerate(found.unknowns):
        if not found.intervals[k] < abs(found.values[k]):
            yield (
                f"{unknown.full} is uncertain by {found.intervals[k]:.2g} {unknown.unit}, at least"
                " its own value: these data hardly determine it"
            )
    for i in range(len(found.unknowns)):
        for j in range(i):
            r = found.correlation[i, j]
            if abs(r) > ALIKE:
                yield (
                    f"{found.unknowns[j].full} and {found.unknowns[i].full} cannot be"
                    f" distinguished: correlation {r:+.3f}"
                )
    if found.widened > 1.0:
        yield (
            f"residuals are not noise (neighbours correlated by {found.lag_one.max():.2f}): the"
            " parts miss something, or the noise is coloured; intervals are"
            f" {found.widened:.1f} times wider for it, and hold for coloured noise only"
        )
    for k, (_, own) in enumerate(found.case.pairs):
        least = NOTABLE * max(found.sizes[k], 1e-300)
        if found.stepping[k] > least and not found.coarse[k]:
            share = found.stepping[k] / np.abs(found.simulated[:, k]).max(initial=1e-300)
            if share > 1e-6:
                yield (
                    f"{own}: half the communication step moves it by {found.stepping[k]:.2g}"
                    f" {found.case.units[k]}; more rows or a smaller --step make it more accurate"
                )


def figure(found: Identified) -> Figure:
    """Recorded and fitted outputs over time, and the residual of each."""
    every = slice(None, None, max(1, len(found.times) // DRAWN))
    time = found.times[every].tolist()
    plots = []
    for k, (_, own) in enumerate(found.case.pairs):
        unit = found.case.units[k] or "1"
        across = Axis("time (s)")
        recorded = found.recorded[every, k].tolist()
        fitted = found.simulated[every, k].tolist()
        left = (found.recorded - found.simulated)[every, k].tolist()
        plots += [
            Plot(own, across, Axis(f"value ({unit})"),
                 [Curve("recorded", time, recorded, "points"), Curve("fitted", time, fitted)]),
            Plot(f"{own}: recorded less fitted", across, Axis(f"residual ({unit})"),
                 [Curve("residual", time, left)]),
        ]  # fmt: skip
    return Figure("fit", "Recorded and fitted", "", plots)


def page(found: Identified) -> Page:
    """The fit as a page that opens offline."""
    columns = [Column("Parameter"), Column("Start", number=True), Column("Fitted", number=True),
               Column("Interval", number=True), Column("Unit")]  # fmt: skip
    rows = [
        [
            Cell(u.full),
            quantity(u.start, f"{u.start:.6g}"),
            quantity(float(found.values[k]), f"{found.values[k]:.6g}"),
            quantity(float(found.intervals[k]), f"+- {found.intervals[k]:.2g}"),
            Cell(u.unit),
        ]
        for k, u in enumerate(found.unknowns)
    ]
    against = list(objections(found))
    lines = list(remarks(found)) or ["No further remark." if against else "No remark speaks against"
                                     " these numbers."]  # fmt: skip
    path = found.case.plan.recordings["recording"].interface.path
    sections = [
        Section(
            "parameters", "Parameters",
            [PageTable("Fitted values", columns, rows), *([Notes(against)] if against else [])],
        ),
        Section("remarks", "Remarks", [Notes(lines)]),
        Section("curves", "Recorded and fitted", [figure(found)]),
    ]  # fmt: skip
    facts = [("Runs", str(found.runs)), ("Rows", str(int(found.counted.sum())))]
    return Page(f"Fit to {path.name}", f"Intervals hold {100 * found.level:g} % of the time where"
                " residuals are independent noise on the outputs.", sections, facts)  # fmt: skip


def facts(found: Identified) -> dict[str, Any]:
    """The fit for scripts, SI."""
    return {
        "parameters": {
            u.full: {
                "start": u.start, "value": float(found.values[k]),
                "interval": float(found.intervals[k]), "unit": u.unit,
            }
            for k, u in enumerate(found.unknowns)
        },
        "level": found.level,
        "correlation": found.correlation.tolist(),
        "singular_values": found.singular.tolist(),
        "outputs": {
            own: {
                "residual_rms": float(found.sizes[k]), "explained": float(found.shares[k]),
                "lag_one": float(found.lag_one[k]), "stepping_error": float(found.stepping[k]),
                "unit": found.case.units[k],
            }
            for k, (_, own) in enumerate(found.case.pairs)
        },
        "objections": list(objections(found)),
        "remarks": list(remarks(found)),
        "rows": int(found.counted.sum()),
        "runs": found.runs,
        "wall_time": found.wall_time,
        "message": found.message,
    }  # fmt: skip
