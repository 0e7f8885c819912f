"""Cells of a text as numbers: decimal points and commas, clock times, missing values."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable
from datetime import date
from pathlib import Path

from ..errors import RecordingError, printable

EMPTY = {
    *("", "-", "--", "---", "nan", "-nan", "na", "n/a", "#n/a", "null", "none"),
    *("1.#qnan", "1.#ind", "-1.#ind"),
}
"""Texts, in lower case, of a value that is missing."""
BLANK = " "
"""As a delimiter: any number of blanks."""
_GROUPS = {
    ".": re.compile(r"[-+]?\d{1,3}(,\d{3})+(\.\d*)?"),
    ",": re.compile(r"[-+]?\d{1,3}(\.\d{3})+(,\d*)?"),
}
"""Numbers with separators of thousands, by their decimal sign."""
_CLOCK = re.compile(
    r"(?:(?P<iso>\d{4}[-/.]\d{1,2}[-/.]\d{1,2})|(?P<dots>\d{1,2}\.\d{1,2}\.\d{4})"
    r"|(?P<slashes>\d{1,2}/\d{1,2}/\d{4}))?[T ]*"
    r"(?P<hours>\d{1,3}):(?P<minutes>\d{2}):(?P<seconds>\d{2}(?:[.,]\d+)?)"
    r"\s*(?P<half>[AaPp][Mm])?(?:Z|[-+]\d{2}:?\d{2})?"
)
DAY = 86400.0


def cells_of(path: Path, number: int, line: str, delimiter: str) -> list[str]:
    """Cells of a line, quotes taken off; `RecordingError` where they cannot be separated."""
    if delimiter == BLANK:
        return [cell.strip("\"'") for cell in line.split()]
    try:
        return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error as error:
        raise RecordingError(f"{path}: line {number}: cannot be read as cells ({error})") from None


def number_of(cell: str, decimal: str, grouped: bool = False) -> float | None:
    """A cell's number: NaN where it is missing, None where it is not a number.

    `decimal` is the sign before the decimals; with `grouped` the other one may separate thousands.
    """
    word = cell.strip().strip("\"'").strip()
    if word.lower() in EMPTY:
        return math.nan
    if "_" in word:
        return None
    if grouped and _GROUPS[decimal].fullmatch(word):
        word = word.replace("." if decimal == "," else ",", "")
    if decimal == ",":
        if "." in word and "," in word:
            return None
        word = word.replace(",", ".")
    try:
        return float(word)
    except ValueError:
        return None


def is_clock(cell: str) -> bool:
    """Whether a cell is a time of day, with or without a date before it."""
    return _CLOCK.fullmatch(cell.strip()) is not None


class Clock:
    """Times of day as seconds since the first one, over midnight too."""

    def __init__(self) -> None:
        self._first: float | None = None
        self._last = 0.0
        self._day: int | None = None
        self._slashes = ""

    def seconds(self, cell: str) -> float | None:
        """Seconds since the first cell; None where a cell is not a time of day.

        Raises `ValueError` where a date could be read in two ways.
        """
        found = _CLOCK.fullmatch(cell.strip())
        if found is None:
            return None
        hours = int(found["hours"])
        if half := (found["half"] or "").lower():
            hours = hours % 12 + 12 * (half == "pm")
        time = 3600.0 * hours + 60.0 * int(found["minutes"])
        time += float(found["seconds"].replace(",", ".")) + DAY * self._days(found)
        dated = found["iso"] or found["dots"]
        if not dated and self._first is not None:
            while time < self._last - DAY / 2.0:
                time += DAY
        self._first = time if self._first is None else self._first
        self._last = time
        return time - self._first

    def _days(self, found: re.Match[str]) -> int:
        """Days since that of the first cell."""
        if slashes := found["slashes"]:
            self._slashes = self._slashes or slashes
            if slashes != self._slashes:
                raise ValueError(
                    f"{slashes} and {self._slashes}: day and month cannot be told apart; write"
                    " dates as 2026-11-28"
                )
        if found["iso"]:
            year, month, day = map(int, re.split(r"[-/.]", found["iso"]))
        elif found["dots"]:
            day, month, year = map(int, found["dots"].split("."))
        else:
            return 0
        ordinal = date(year, month, day).toordinal()
        self._day = ordinal if self._day is None else self._day
        return ordinal - self._day


class Decimals:
    """The decimal sign of a file, and what speaks for each: commas beside points are refused.

    `place` makes the beginning of a message from a line and a column's heading. `given` is the
    scenario's own `decimal`, with which the other sign separates thousands.
    """

    def __init__(self, given: str, delimiter: str, place: Callable[[int, str], str]) -> None:
        self.given = given
        self.sign = given or ("." if delimiter == "," else "")
        self._place = place
        self._seen: dict[str, tuple[int, str]] = {}

    def note(self, number: int, heading: str, cell: str) -> None:
        """Take notice of a cell's comma or point; `RecordingError` where the file has both."""
        if self.sign:
            return
        for sign, other in (",.", ".,"):
            if sign not in cell or other in cell:
                continue
            self._seen.setdefault(sign, (number, cell))
            if other in self._seen:
                line, before = self._seen[other]
                raise RecordingError(
                    f"{self._place(number, heading)}: {printable(cell, most=60)!r} beside"
                    f" {printable(before, most=60)!r} in line {line}: decimals or thousands? say"
                    ' which sign is the decimal one, as decimal = "." or decimal = ","'
                )

    def number(self, cell: str) -> float | None:
        """Number in a cell; without any other sign of it, a comma is a decimal comma."""
        sign = self.sign or ("," if "," in cell else ".")
        return number_of(cell, sign, grouped=bool(self.given))
