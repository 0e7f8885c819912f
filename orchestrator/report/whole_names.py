"""Tables of a terminal whose names can be copied: other columns wrap around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

WIDEST = 48
"""Columns of names that are wider together are folded, so that others have room at all."""


def keep_whole(table: Table, *names: int) -> Table:
    """The table with nothing cut, and with no line break in the columns of `names`."""
    for column in table.columns:
        column.overflow = "fold"
    columns = [table.columns[k] for k in names]
    width = sum(max((len(str(cell)) for cell in each.cells), default=0) for each in columns)
    for column in columns:
        column.no_wrap = width <= WIDEST
    return table
