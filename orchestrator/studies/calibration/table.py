"""A calibration as tables and as data for scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...errors import printable
from .study import Calibration

if TYPE_CHECKING:
    from rich.table import Table


def parameters(found: Calibration) -> Table:
    """Each parameter: what the scenarios carry, what the fit gives, how surely."""
    from rich.table import Table

    made = Table(title=printable(found.fit.title or found.fit.name), title_justify="left")
    for label in ("parameter", "in the scenarios", "fitted (SI)", "moved", "for 1 % on all data"):
        made.add_column(label)
    for k, parameter in enumerate(found.fit.parameters):
        moved = found.fitted[k] / found.shipped[k] - 1.0
        made.add_row(
            printable(parameter.name), f"{parameter.value}", f"{found.fitted[k]:.5g}",
            f"{moved:+.2%}", f"{found.spread[k]:.1%}",
        )  # fmt: skip
    return made


def data(found: Calibration) -> Table:
    """Each datum: the paper's value, and how far ours is off."""
    from rich.table import Table

    made = Table("datum", "of", "paper", "error", "")
    for k, datum in enumerate(found.fit.data):
        role = "predicted" if datum.held_out else "fitted"
        error = f"{found.errors[k]:+.2%}"
        made.add_row(printable(datum.name), printable(datum.where), f"{datum.value}", error, role)
    return made


def sensitivities(found: Calibration) -> Table:
    """What each datum hangs on: d ln datum / d ln parameter."""
    from rich.table import Table

    made = Table("d ln / d ln")
    for parameter in found.fit.parameters:
        made.add_column(printable(parameter.name))
    for k, datum in enumerate(found.fit.data):
        made.add_row(printable(datum.name), *(f"{s:+.2f}" for s in found.sensitivity[k]))
    return made


def facts(found: Calibration) -> dict[str, Any]:
    """The same for scripts."""
    fit = found.fit
    return {
        "fit": fit.name,
        "parameters": {
            p.name: {
                "shipped": found.shipped[k],
                "fitted": found.fitted[k],
                "spread": found.spread[k],
            }
            for k, p in enumerate(fit.parameters)
        },
        "data": {
            d.name: {
                "paper": found.paper[k],
                "ours": found.after[k],
                "error": found.errors[k],
                "held_out": d.held_out,
                "sensitivity": {
                    p.name: float(s)
                    for p, s in zip(fit.parameters, found.sensitivity[k], strict=True)
                },
            }
            for k, d in enumerate(fit.data)
        },
        "singular_values": found.singular.tolist(),
        "correlation": found.correlation.tolist(),
        "runs": found.runs,
        "wall_time": found.wall_time,
        "message": found.message,
    }  # fmt: skip
