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
from .study import Identified

if TYPE_CHECKING:
    from rich.table import Table

DRAWN = 1500
"""Points of a curve that a picture gets."""
ALIKE = 0.99
"""Correlation from which two parameters cannot be told apart."""
NOTABLE = 0.1
"""Stepping error, of the residuals' size, from which it is worth a remark."""


def parameters(found: Identified) -> Table:
    """Each parameter: from where, to where, how surely."""
    from rich.table import Table

    made = Table(title=printable(found.case.plan.scenario.title), title_justify="left")
    for label in ("parameter", "start", "fitted", f"interval, {100 * found.level:g} %", "unit"):
        made.add_column(label, justify="left" if label in {"parameter", "unit"} else "right")
    for k, unknown in enumerate(found.unknowns):
        made.add_row(
            printable(unknown.full), f"{unknown.start:.6g}", f"{found.values[k]:.6g}",
            f"+- {found.intervals[k]:.2g}", unknown.unit,
        )  # fmt: skip
    return made


def outputs(found: Identified) -> Table:
    """Each output: what is left, what is explained, whether the rest is noise."""
    from rich.table import Table

    made = Table("output", "residual, rms", "explained", "neighbours", "stepping error")
    for k, (_, own) in enumerate(found.case.pairs):
        unit = found.case.units[k]
        made.add_row(
            printable(own), f"{found.sizes[k]:.3g} {unit}", f"{100 * found.shares[k]:.3f} %",
            f"{found.lag_one[k]:+.2f}", f"{found.stepping[k]:.2g} {unit}",
        )  # fmt: skip
    return made


def remarks(found: Identified) -> Iterator[str]:
    """What speaks against taking the numbers as they are."""
    for name in found.at_bounds:
        yield f"{name} has gone to the end of its range: the data want it beyond, or do not see it"
    for k, unknown in enumerate(found.unknowns):
        if not found.intervals[k] < abs(found.values[k]):
            yield (
                f"{unknown.full} is uncertain by {found.intervals[k]:.2g} {unknown.unit}, as much"
                " as it is: these data hardly see it"
            )
    for i in range(len(found.unknowns)):
        for j in range(i):
            r = found.correlation[i, j]
            if abs(r) > ALIKE:
                yield (
                    f"{found.unknowns[j].full} and {found.unknowns[i].full} cannot be told apart:"
                    f" correlation {r:+.3f}"
                )
    if found.widened > 1.0:
        yield (
            f"residuals are no noise (neighbours correlated by {found.lag_one.max():.2f}): the"
            " parts miss something, or the noise is coloured; intervals are"
            f" {found.widened:.1f} times wider for it, and hold for coloured noise only"
        )
    for k, (_, own) in enumerate(found.case.pairs):
        if found.stepping[k] > NOTABLE * max(found.sizes[k], 1e-300) and found.stepping[k] > 0.0:
            share = found.stepping[k] / np.abs(found.simulated[:, k]).max(initial=1e-300)
            if share > 1e-6:
                yield (
                    f"{own}: half the communication step moves it by {found.stepping[k]:.2g}"
                    f" {found.case.units[k]}; more rows, or a smaller --step, would say more"
                )


def figure(found: Identified) -> Figure:
    """Recorded and fitted outputs over time, and what is left of each."""
    every = slice(None, None, max(1, len(found.times) // DRAWN))
    time = found.times[every].tolist()
    plots = []
    for k, (_, own) in enumerate(found.case.pairs):
        unit = found.case.units[k] or "1"
        across = Axis("time (s)")
        told, ours = found.recorded[every, k].tolist(), found.simulated[every, k].tolist()
        left = (found.recorded - found.simulated)[every, k].tolist()
        plots += [
            Plot(own, across, Axis(f"value ({unit})"),
                 [Curve("recorded", time, told, "points"), Curve("fitted", time, ours)]),
            Plot(f"{own}: recorded less fitted", across, Axis(f"residual ({unit})"),
                 [Curve("residual", time, left)]),
        ]  # fmt: skip
    return Figure("fit", "Recorded and fitted", "", plots)


def page(found: Identified) -> Page:
    """The same as a page that opens offline."""
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
    said = list(remarks(found)) or ["Nothing speaks against these numbers."]
    path = found.case.plan.recordings["recording"].interface.path
    sections = [
        Section("parameters", "Parameters", [PageTable("Fitted values", columns, rows)]),
        Section("remarks", "Remarks", [Notes(said)]),
        Section("curves", "Recorded and fitted", [figure(found)]),
    ]
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
        "remarks": list(remarks(found)),
        "rows": int(found.counted.sum()),
        "runs": found.runs,
        "wall_time": found.wall_time,
        "message": found.message,
    }  # fmt: skip
