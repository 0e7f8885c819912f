"""A card: what an object shows of itself in a notebook, as a piece of HTML without any script."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..errors import printable
from .page import environment
from .table import Cell, Column, Table

if TYPE_CHECKING:
    from rich.table import Table as RichTable

LONGEST = 1000
"""Characters of one cell."""


@dataclass(frozen=True)
class Card:
    """A title, lines of text and tables; `more` are tables that are folded away at first."""

    title: str
    lines: Sequence[str] = ()
    tables: Sequence[Table] = ()
    more: Sequence[Table] = field(default=())


def rendered(card: Card) -> str:
    """The card as HTML, all texts escaped."""
    return environment().get_template("notebook.html").render(card=card)


def of_terminal(table: RichTable) -> Table:
    """A table made for the terminal as one of a page: the same titles and texts."""
    columns = [Column(str(column.header)) for column in table.columns]
    texts = [[printable(str(c), most=LONGEST) for c in column.cells] for column in table.columns]
    rows = [[Cell(text) for text in row] for row in zip(*texts, strict=True)]
    return Table(str(table.title or ""), columns, rows)
