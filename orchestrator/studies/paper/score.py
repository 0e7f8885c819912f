"""The score of a figure or table: one line that says how its numbers compare."""

from __future__ import annotations

import math
from collections.abc import Sequence

from .comparison import Row


def score(rows: Sequence[Row]) -> str:
    """How many rows hold the paper's number in their band or agree, and the largest errors.

    A calibrated number has met the paper's by its fit, so its band does not judge it. Errors of
    undecidable readings are told apart: at most one of the readings can be meant.
    """
    judged = [row.held for row in rows if row.held is not None]
    claims = [row.agrees for row in rows if row.agrees is not None]
    errors = [row for row in rows if math.isfinite(row.error)]
    firm = [row.error for row in errors if row.mark.kind != "undecidable"]
    open_ = [row.error for row in errors if row.mark.kind == "undecidable"]
    told = []
    if judged:
        told.append(f"{sum(judged)} of {len(judged)} within their band")
    elif errors:
        told.append(f"{len(errors)} numbers" if len(errors) > 1 else "1 number")
    if claims:
        told.append(f"{sum(claims)} of {len(claims)} claims agree")
    if firm:
        told.append(f"largest error {_percent(firm)}")
    if open_:
        told.append(
            f"{'of' if firm else 'largest error of'} undecidable readings {_percent(open_)}"
        )
    return ", ".join(told)


def _percent(errors: Sequence[float]) -> str:
    return f"{100.0 * max(errors, key=abs):+.1f}\N{NO-BREAK SPACE}%"
