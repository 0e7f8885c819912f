"""Where a text has its headings, its units and its rows: as the scenario says, else found out.

Instruments write lines about themselves first, headings over one row or two, and sometimes the
names of columns in a comment. Rows begin with the first of two lines whose first cell is a number
or a time of day; the headings are above them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import RecordingError
from ..units import UnitError, check_unit
from .cells import BLANK, EMPTY, cells_of, is_clock, number_of
from .columns import CLOCKS, Heading, unit_in
from .text_lines import COMMENTS

DELIMITERS = "\t;|," + BLANK
HEAD = 1000
"""Lines among which rows have to begin."""
_BLANK_HEADING = re.compile(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?')
Line = tuple[int, str]


@dataclass(frozen=True)
class Layout:
    """What a scenario says of a text's layout; lines count from 1, `headings` 0 is none at all."""

    skip: int = 0
    headings: int | None = None
    units_row: int | None = None
    names: tuple[str, ...] = ()
    encoding: str = ""
    decimal: str = ""


@dataclass(frozen=True)
class Structure:
    """Where the rows of a text begin, how many cells each has, and what the columns are called.

    `clocks` are the places of columns of times of day. `sampling` holds the start and the interval
    [s] of a file whose first column counts samples.
    """

    delimiter: str
    headings: list[Heading]
    line: int
    first: int
    width: int
    clocks: tuple[int, ...] = ()
    sampling: tuple[float, float] | None = None


@dataclass
class Head:
    """The first lines of a text, and what the scenario says of them."""

    path: Path
    lines: list[Line]
    layout: Layout
    clocks: set[str] = field(default_factory=set)

    def structure(self) -> Structure:
        """The structure; `RecordingError` where there are no headings or no columns."""
        for key in ("headings", "units_row"):
            line = getattr(self.layout, key)
            if line and line not in {n for n, _ in self.lines}:
                raise RecordingError(f"{self.path}: {key}: there is no line {line} above rows")
        above = max(self.layout.skip, self.layout.headings or 0, self.layout.units_row or 0)
        text = [(n, t) for n, t in self.lines if t.strip() and not t.startswith(COMMENTS)]
        text = [(n, t) for n, t in text if n > self.layout.skip]
        named = re.fullmatch(r"sep=(.)", text[0][1].strip()) if text else None
        text = text[1:] if named else text
        if not text:
            raise RecordingError(f"{self.path}: is empty: no headings, no rows")
        for is_row in (_is_plain_row, _is_row):
            for delimiter in named[1] if named else DELIMITERS:
                begin = self._begin(text, delimiter, above, is_row)
                if begin is not None:
                    return self._named(text, begin, delimiter)
        number, line = text[0]
        plain = re.sub(r'"[^"]*"', "", line)
        delimiter = named[1] if named else next((d for d in DELIMITERS if d in plain), "")
        if not delimiter:
            raise RecordingError(
                f"{self.path}: line {number}: no comma, semicolon or tab between two headings; a"
                " recording has a column of time and one of values"
            )
        if self.layout.headings == 0 or self.layout.names:
            return self._named(text, 0, delimiter)
        cells = self._headings(number, line, delimiter)
        following = text[1][0] if len(text) > 1 else number + 1
        return Structure(delimiter, cells, number, following, len(cells))

    def _cells(self, line: Line, delimiter: str) -> list[str]:
        return cells_of(self.path, line[0], line[1], delimiter)

    def _begin(
        self, text: list[Line], delimiter: str, above: int, is_row: Callable[[list[str]], bool]
    ) -> int | None:
        """Place of the first row among the lines; None where no two lines are rows."""
        for k, line in enumerate(text):
            if line[0] <= above or not is_row(self._cells(line, delimiter)):
                continue
            following = text[k + 1 : k + 2]
            if all(is_row(self._cells(other, delimiter)) for other in following):
                while k and text[k - 1][0] > above and self._goes_on(text[k - 1], delimiter):
                    k -= 1
                return k
        return None

    def _goes_on(self, line: Line, delimiter: str) -> bool:
        """Whether a line above a row is a row too: it begins as one, or there are no headings."""
        return self.layout.headings == 0 or _starts(self._cells(line, delimiter))

    def _named(self, text: list[Line], begin: int, delimiter: str) -> Structure:
        """The structure of a text whose rows begin at a place among its lines."""
        first, row = text[begin][0], self._cells(text[begin], delimiter)
        clocks = tuple(k for k, cell in enumerate(row) if is_clock(cell))
        before = text[:begin]
        number, headings = self._found(before, row, delimiter, first)
        units = self._units(before, number, delimiter)
        while headings and not headings[-1].text and len(headings) > len(row):
            headings.pop()
        filled = max(k for k, cell in enumerate(row, start=1) if cell.strip())
        if number and headings and not filled <= len(headings) <= len(row):
            raise RecordingError(
                f"{self.path}: line {first}: has {len(row)} cells, but there are {len(headings)}"
                f" headings in line {number}"
            )
        headings += [Heading("", "", "")] * (len(row) - len(headings))
        for k, unit in enumerate(units[: len(headings)]):
            if unit and not (headings[k].unit and _is_unit(headings[k].unit)):
                headings[k] = Heading(headings[k].text, headings[k].name, unit)
        sampling = self._sampling(before, delimiter)
        if sampling:
            headings[0] = Heading(headings[0].text, "time", "s")
        return Structure(delimiter, headings, number or first, first, len(row), clocks, sampling)

    def _found(
        self, before: list[Line], row: list[str], delimiter: str, first: int
    ) -> tuple[int, list[Heading]]:
        """Line and cells of the headings; 0 and none where the columns are known by number."""
        given = self.layout.headings
        if self.layout.names:
            return 0, [Heading.of(name) for name in self.layout.names]
        if given is not None:
            line = next((t for n, t in self.lines if n == given), "")
            return given, self._headings(given, line, delimiter) if given else []
        if before:
            number, line = before[-1]
            if self._is_units_row(before, delimiter):
                number, line = before[-2]
            return number, self._headings(number, line, delimiter)
        for number, line in reversed([p for p in self.lines if p[0] < first]):
            headings = self._headings(number, line.lstrip("#% "), delimiter)
            if line.startswith(COMMENTS) and len(headings) == len(row):
                return number, headings
        return 0, []

    def _headings(self, number: int, line: str, delimiter: str) -> list[Heading]:
        line = line.lstrip("#% ") if line.startswith(COMMENTS) else line
        if delimiter == BLANK:
            cells = [cell.strip('"') for cell in _BLANK_HEADING.findall(line)]
        else:
            cells = cells_of(self.path, number, line, delimiter)
        return [Heading.of(cell) for cell in cells]

    def _is_units_row(self, before: list[Line], delimiter: str) -> bool:
        """Whether the last line above the rows has the units of the headings above it."""
        if len(before) < 2:
            return False
        last, above = (self._cells(line, delimiter) for line in (before[-1], before[-2]))
        if _is_counting(last):
            return True
        cells = [cell for cell in last if cell.strip()]
        named = any(Heading.of(c).name.lower() in CLOCKS or c in self.clocks for c in cells)
        titles = [cell for cell in above if cell.strip()]
        return not named and len(titles) >= max(2, len(cells)) and all(map(_is_unit, cells))

    def _units(self, before: list[Line], number: int, delimiter: str) -> list[str]:
        """Units by column: of the row that has them, or of a scope's lines about its axes."""
        given = self.layout.units_row
        if given is not None:
            text = next(t.lstrip("#% ") for n, t in self.lines if n == given)
            return [unit_in(cell) for cell in self._cells((given, text), delimiter)]
        if before and number and before[-1][0] > number:
            cells = self._cells(before[-1], delimiter)
            if _is_counting(cells):
                return ["", unit_in(cells[1])]
            return [unit_in(cell) for cell in cells]
        known = {c[0].strip().lower(): c[1:] for c in (self._cells(p, delimiter) for p in before)}
        axes = [known.get(f"{axis} units", []) for axis in ("horizontal", "vertical")]
        return [*axes[0][:1], *axes[1]] if all(axes) else []

    def _sampling(self, before: list[Line], delimiter: str) -> tuple[float, float] | None:
        """Start and interval of a file whose first column counts samples, as Rigol writes it."""
        if len(before) < 2:
            return None
        above, last = (self._cells(line, delimiter) for line in before[-2:])
        titles = [cell.strip().lower() for cell in above]
        if not (_is_counting(last) and {"start", "increment"} <= {*titles}):
            return None
        values = [number_of(last[titles.index(key)], ".") for key in ("start", "increment")]
        start, interval = values
        return None if start is None or not interval else (start, interval)


def _starts(cells: list[str]) -> bool:
    """Whether the first cell that is not empty is a number or a time of day."""
    cell = next((cell for cell in cells if cell.strip()), "")
    if is_clock(cell) or re.fullmatch(r"\d{4}[-/]\d\d[-/]\d\d|\d\d[./]\d\d[./]\d{4}", cell.strip()):
        return True
    return cell.strip().lower() not in EMPTY and number_of(cell, ",") is not None


def _is_row(cells: list[str]) -> bool:
    """Whether cells are a row: a number or a time first, and one more or a missing one."""
    others = [c for c in cells if is_clock(c) or number_of(c, ",") is not None]
    return len(others) >= 2 and _starts(cells)


def _is_plain_row(cells: list[str]) -> bool:
    """Whether cells are a row without any texts."""
    return _is_row(cells) and all(is_clock(c) or number_of(c, ",") is not None for c in cells)


def _is_counting(cells: list[str]) -> bool:
    return len(cells) > 2 and cells[0].strip().lower() == "sequence"


def _is_unit(cell: str) -> bool:
    try:
        check_unit(unit_in(cell))
    except UnitError:
        return False
    return True
