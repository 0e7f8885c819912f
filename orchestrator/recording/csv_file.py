"""CSV: read in pieces, its structure found out or given, faults reported with their line."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path

import numpy as np

from ..errors import RecordingError, printable
from .cells import BLANK, Clock, Decimals, cells_of
from .columns import Choice
from .layout import HEAD, Head, Layout, Line, Structure
from .table import TIME, Column, Table, Values
from .text_lines import COMMENTS, text_lines

PIECE = 1 << 15
"""Lines that are converted into numbers at once."""


PLAIN = Layout()
"""A text of which the scenario says nothing."""


def read_csv(path: Path, choice: Choice, layout: Layout = PLAIN) -> Table:
    """Table of a text: headings, units and rows where `layout` says, else where they are found.

    Comment lines hold `key: value`. Raises :class:`RecordingError` with the line.
    """
    lines = text_lines(path, layout.encoding)
    head = list(islice(lines, HEAD))
    clocks = {key for key, name in (choice.columns or {}).items() if name == TIME}
    structure = Head(path, head, layout, clocks).structure()
    if not any(h.text for h in structure.headings) and not choice.numbered:
        raise RecordingError(
            f"{path}: line {structure.line}: no headings; name the columns, as"
            f" time [s]{structure.delimiter}force.value [N], or by number or names in the scenario"
        )
    where = f"line {structure.line}"
    columns = choice.columns_of(path, where, structure.headings, structure.clocks)
    rows = _Rows(path, structure, columns, layout.decimal)
    comments: dict[str, str] = {}
    following = _following(chain(head, lines), structure.first, comments)
    pieces: list[Values] = []
    numbers: list[int] = []
    while piece := list(islice(following, PIECE)):
        pieces.append(rows.numbers(piece))
        numbers += [k for k, _ in piece]
    values = np.concatenate(pieces) if pieces else np.zeros((0, len(columns)))
    times = values[:, 0]
    if structure.sampling and not choice.interval:
        times = structure.sampling[0] + structure.sampling[1] * times
    return Table(path, columns, times, values[:, 1:], np.array(numbers), "line", comments)


def _following(lines: Iterator[Line], first: int, comments: dict[str, str]) -> Iterator[Line]:
    """Rows from the first one; comment lines anywhere are added to `comments`."""
    for number, text in lines:
        if text.startswith(COMMENTS):
            key, colon, value = text[1:].partition(":")
            if colon:
                comments.setdefault(key.strip(), value.strip())
        elif number >= first and text.strip():
            yield number, text


class _Rows:
    """Rows of a text as numbers of the columns in use."""

    def __init__(
        self, path: Path, structure: Structure, columns: list[Column], decimal: str
    ) -> None:
        self._path = path
        self._structure = structure
        self._columns = columns
        self._decimals = Decimals(decimal, structure.delimiter, self._place)
        self._clock = Clock() if columns[0].place in structure.clocks else None

    def _place(self, number: int, heading: str) -> str:
        return f"{self._path}: line {number}: column {printable(heading)!r}"

    def numbers(self, piece: list[Line]) -> Values:
        """A piece of rows: all at once where they are plain, else cell by cell."""
        plain = self._plain([text for _, text in piece])
        if plain is not None:
            for column, cell in self._used(*piece[0]):
                self._decimals.note(piece[0][0], column.heading, cell)
            return plain
        made = np.empty((len(piece), len(self._columns)))
        for k, (number, text) in enumerate(piece):
            for j, (column, cell) in enumerate(self._used(number, text)):
                made[k, j] = self._number(number, column, cell)
        return made

    def _plain(self, texts: list[str]) -> Values | None:
        """Rows without clock times, quotes, and without both commas and points in numbers."""
        delimiter = self._structure.delimiter
        if self._clock is not None or self._decimals.given:
            return None
        if delimiter != "," and any("," in text for text in texts):
            if any("." in text for text in texts):
                return None
            texts = [text.replace(",", ".") for text in texts]
        split = None if delimiter == BLANK else delimiter
        for text in texts:
            count = len(text.split()) if split is None else text.count(split) + 1
            if count != self._structure.width:
                return None
        places = [column.place for column in self._columns]
        try:
            return np.loadtxt(texts, delimiter=split, usecols=places, comments=None, ndmin=2)
        except ValueError:
            return None

    def _used(self, number: int, text: str) -> Iterator[tuple[Column, str]]:
        """Cells of the columns in use."""
        cells = cells_of(self._path, number, text, self._structure.delimiter)
        width = self._structure.width
        if len(cells) < width or any(cell.strip() for cell in cells[width:]):
            raise RecordingError(
                f"{self._path}: line {number}: has {len(cells)} cells, but there are {width}"
                " in the first row"
            )
        yield from ((column, cells[column.place]) for column in self._columns)

    def _number(self, number: int, column: Column, cell: str) -> float:
        if self._clock is not None and column.name == TIME:
            value = self._seconds(number, column, cell)
        else:
            self._decimals.note(number, column.heading, cell)
            value = self._decimals.number(cell)
        if value is None:
            hint = '; decimal = "," or "." says what a comma is' if "," in cell else ""
            raise RecordingError(
                f"{self._place(number, column.heading)}: {printable(cell, most=60)!r} is not a"
                f" number{hint}"
            )
        return value

    def _seconds(self, number: int, column: Column, cell: str) -> float | None:
        assert self._clock is not None
        try:
            return self._clock.seconds(cell)
        except ValueError as error:
            raise RecordingError(f"{self._place(number, column.heading)}: {error}") from None
