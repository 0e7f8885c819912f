"""A calibration as tables and as data for scripts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...errors import printable
from ...report.whole_names import keep_whole
from .fits import Datum, Fit
from .profile import Point
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
    return keep_whole(made, 0)


def data(found: Calibration) -> Table:
    """Each datum: the paper's value, and how far ours is off."""
    from rich.table import Table

    made = Table("datum", "of", "paper", "ours (SI)", "error", "")
    for k, datum in enumerate(found.fit.data):
        role = _role(found, k) if datum.held_out else "fitted"
        stated, error = f"{datum.value}", f"{found.errors[k]:+.2%}"
        if datum.value is None:
            stated, error = "-", "-"
        made.add_row(
            printable(datum.name),
            printable(datum.where),
            stated,
            f"{found.after[k]:.4g}",
            error,
            role,
        )
    return made


def _role(found: Calibration, k: int) -> str:
    """A predicted datum, its band by what the fitted ones are uncertain, and what that tells."""
    band = float(found.band[k])
    if not math.isfinite(band):
        return "predicted"
    text = f"predicted +- {band:.1%}"
    if not math.isfinite(found.errors[k]):
        return text
    held = abs(found.errors[k]) <= band
    return f"{text}, {'which holds' if held else 'which does not hold'} the paper's"


def points(fit: Fit, found: Sequence[Point]) -> Table:
    """A profile: the parameters fitted at each share, and the data that were not."""
    from rich.table import Table

    assert fit.profile is not None
    made = Table(title=printable(fit.profile.name), title_justify="left")
    for label in ("share", *(p.name for p in fit.parameters), *(d.name for d in _held_out(fit))):
        made.add_column(printable(label))
    for point in found:
        held_out = [value for d, value in zip(fit.data, point.data, strict=True) if d.held_out]
        made.add_row(f"{point.share:g}", *(f"{v:.4g}" for v in (*point.parameters, *held_out)))
    return made


def _held_out(fit: Fit) -> list[Datum]:
    return [datum for datum in fit.data if datum.held_out]


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
                "paper": _number(found.paper[k]),
                "ours": found.after[k],
                "error": _number(found.errors[k]),
                "held_out": d.held_out,
                "band": _number(found.band[k]),
                "sensitivity": {
                    p.name: float(s)
                    for p, s in zip(fit.parameters, found.sensitivity[k], strict=True)
                },
            }
            for k, d in enumerate(fit.data)
        },
        "singular_values": found.singular.tolist(),
        "covariance": found.covariance.tolist(),
        "correlation": found.correlation.tolist(),
        "runs": found.runs,
        "wall_time": found.wall_time,
        "message": found.message,
    }  # fmt: skip


def point_facts(fit: Fit, found: Sequence[Point]) -> dict[str, Any]:
    """A profile for scripts, SI."""
    assert fit.profile is not None
    return {
        "profile": fit.profile.name,
        "shares": [point.share for point in found],
        "parameters": {
            p.name: [float(point.parameters[k]) for point in found]
            for k, p in enumerate(fit.parameters)
        },
        "data": {d.name: [float(point.data[k]) for point in found] for k, d in enumerate(fit.data)},
    }


def _number(value: float) -> float | None:
    """JSON has no NaN."""
    return float(value) if math.isfinite(value) else None
