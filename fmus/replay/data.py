"""The record as module constants: knots, polynomials between them, their running integrals."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

_RECORD: dict[str, Any] = json.loads(
    (Path(__file__).parent / "record.json").read_text(encoding="utf-8")
)


def _tuples(value: Any) -> Any:
    return tuple(_tuples(entry) for entry in value) if isinstance(value, list) else value


KNOTS: tuple[tuple[float, ...], ...] = _tuples([_RECORD["knots"]])
"""Times [s], in one row."""

PIECES: tuple[tuple[tuple[float, ...], ...], ...] = _tuples(_RECORD["pieces"])
"""Column, piece, power of the time from the piece's knot."""

LAST: tuple[tuple[float, ...], ...] = _tuples([_RECORD["last"]])
"""Value of each column at the last knot, in one row."""

FIRST: tuple[tuple[float, ...], ...] = _tuples(_RECORD["first"])
"""Integral of each column from the first knot to each."""

SECOND: tuple[tuple[float, ...], ...] = _tuples(_RECORD["second"])
"""The same of the column's square."""

EVENTS: tuple[tuple[float, ...], ...] = _tuples([_RECORD["events"]])
"""Times of discontinuities in the record's clock [s], and one beyond all, in one row."""

COUNT: int = len(KNOTS[0]) - 1
POWERS: int = len(PIECES[0][0])
TURNS: int = len(EVENTS[0]) - 1
BEGIN: float = KNOTS[0][0]
PERIOD: float = _RECORD["period"]
END: float = BEGIN + PERIOD if PERIOD > 0.0 else KNOTS[0][-1]
GRAIN: float = _RECORD["grain"]
"""What is closer to a knot than this is at it [s]."""
