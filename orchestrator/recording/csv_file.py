"""CSV: read in pieces, delimiter and decimal comma detected, faults reported with their line."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from ..errors import RecordingError, printable
from .columns import Choice, Heading
from .table import Column, Table, Values

PIECE = 1 << 15
"""Lines that are converted into numbers at once."""
DELIMITERS = "\t;|,"
COMMENTS = ("#", "%")
EMPTY = {"", "nan", "na", "n/a", "null", "none"}
LONGEST_LINE = 1 << 20
Lines = list[tuple[int, str]]


def read_csv(path: Path, choice: Choice) -> Table:
    """Table of a CSV file, UTF-8, with a line of headings; comment lines hold `key: value`."""
    comments: dict[str, str] = {}
    lines = _lines(path, comments)
    number, header = next(lines, (0, ""))
    if not number:
        raise RecordingError(f"{path}: is empty: no headings, no rows")
    plain = re.sub(r'"[^"]*"', "", header)
    delimiter = next((d for d in DELIMITERS if d in plain), "")
    if not delimiter:
        raise RecordingError(
            f"{path}: line {number}: no comma, semicolon or tab between two headings; a recording"
            " has a column of time and one of values"
        )
    cells = _cells(header, delimiter)
    if all(_number(cell, delimiter != ",") is not None for cell in cells):
        raise RecordingError(
            f"{path}: line {number}: no headings; name the columns, as time [s]{delimiter}"
            "force.value [N]"
        )
    columns = choice.columns_of(path, f"line {number}", [Heading.of(cell) for cell in cells])
    pieces: list[Values] = []
    rows: list[int] = []
    while piece := list(islice(lines, PIECE)):
        pieces.append(_numbers(path, piece, delimiter, len(cells), columns))
        rows += [k for k, _ in piece]
    numbers = np.concatenate(pieces) if pieces else np.zeros((0, len(columns)))
    return Table(path, columns, numbers[:, 0], numbers[:, 1:], np.array(rows), "line", comments)


def _lines(path: Path, comments: dict[str, str]) -> Iterator[tuple[int, str]]:
    """Lines with content, numbered from 1; comment lines are added to `comments`."""
    with path.open("rb") as file:
        for number, raw in enumerate(iter(lambda: file.readline(LONGEST_LINE), b""), start=1):
            if number == 1:
                if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
                    raise RecordingError(f"{path}: line 1: is UTF-16; save it as UTF-8")
                raw = raw.removeprefix(b"\xef\xbb\xbf")
            try:
                text = raw.decode("utf-8").strip("\r\n")
            except UnicodeDecodeError as error:
                raise RecordingError(
                    f"{path}: line {number}: is not UTF-8 at its byte {error.start + 1}"
                    f" (0x{raw[error.start]:02x}); save it as UTF-8"
                ) from None
            if "\0" in text or len(raw) == LONGEST_LINE:
                raise RecordingError(f"{path}: line {number}: is not text of a table")
            if text.startswith(COMMENTS):
                key, colon, value = text[1:].partition(":")
                if colon:
                    comments.setdefault(key.strip(), value.strip())
            elif text.strip():
                yield number, text


def _cells(line: str, delimiter: str) -> list[str]:
    return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])


def _numbers(path: Path, piece: Lines, delimiter: str, width: int, columns: list[Column]) -> Values:
    """Rows as numbers: all at once where they are plain, else cell by cell."""
    places = [column.place for column in columns]
    texts = [text for _, text in piece]
    if delimiter != ",":
        texts = [text.replace(",", ".") for text in texts]
    if all(text.count(delimiter) == width - 1 for text in texts):
        try:
            return np.loadtxt(texts, delimiter=delimiter, usecols=places, comments=None, ndmin=2)
        except ValueError:
            pass
    made = np.empty((len(piece), len(columns)))
    for k, (number, text) in enumerate(piece):
        cells = _cells(text, delimiter)
        if len(cells) != width:
            raise RecordingError(
                f"{path}: line {number}: has {len(cells)} cells, but there are {width} headings"
            )
        for j, column in enumerate(columns):
            value = _number(cells[column.place], delimiter != ",")
            if value is None:
                raise RecordingError(
                    f"{path}: line {number}: column {printable(column.heading)!r}:"
                    f" {printable(cells[column.place], most=60)!r} is not a number"
                )
            made[k, j] = value
    return made


def _number(cell: str, comma: bool) -> float | None:
    """A cell's number: NaN where it is empty, None where it is not a number."""
    word = cell.strip()
    if word.lower() in EMPTY:
        return math.nan
    if "_" in word:
        return None
    try:
        return float(word.replace(",", ".") if comma else word)
    except ValueError:
        return None
