"""The content of a file: columns of numbers over time, each row with its place in the file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import printable

Values = NDArray[np.float64]
TIME = "time"


@dataclass(frozen=True)
class Column:
    """A column that is used: its place in the file, heading, variable and unit, "" if not given.

    What counts is `gain` times the file's number plus `shift`, in that unit.
    """

    place: int
    heading: str
    name: str
    unit: str
    gain: float = 1.0
    shift: float = 0.0


@dataclass(frozen=True)
class Table:
    """Values of the columns `columns` at `times` [s], NaN where a cell is empty.

    `rows` counts lines of a text, or rows of a binary file, from 1; `word` is "line" or "row".
    `comments` are the keys and texts that the file holds beside its numbers.
    """

    path: Path
    columns: list[Column]
    times: Values
    values: Values
    rows: NDArray[np.int64]
    word: str = "row"
    comments: dict[str, str] = field(default_factory=dict)

    def at(self, k: int, j: int | None = None) -> str:
        """Place of a row, or of its value in column `j` of `values`, to begin an error.

        Row `len(times)` is the first one again, in a record that is repeated.
        """
        row = f"{self.path}: {self.word} {self.rows[k % len(self.rows)]}"
        return row if j is None else f"{row}: column {printable(self.columns[j + 1].heading)!r}"
