"""A table of a page: columns that can be sorted, cells that may be badges or links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

Tone = Literal["plain", "green", "amber", "blue", "red", "grey"]


@dataclass(frozen=True)
class Cell:
    """One text of a row. `sort` is the number that it is ordered by, if not by its text.

    A `tone` makes it a badge; `note` is shown in smaller letters below.
    """

    text: str
    sort: float | None = None
    tone: Tone = "plain"
    note: str = ""


@dataclass(frozen=True)
class Column:
    """A heading; numbers are aligned to the right and sort downwards first."""

    title: str
    number: bool = False


@dataclass(frozen=True)
class Table:
    """Rows under columns."""

    kind: ClassVar[str] = "table"
    title: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Cell]]


def quantity(value: float, text: str, note: str = "") -> Cell:
    """A number as it is shown, sorted by its value."""
    return Cell(text, value, note=note)
