"""netCDF, MATLAB and Parquet: columns by name, rows counted from 1.

Only the columns in use are read, once the size that they declare is known to be allowed: a small
file may unpack to any number of bytes.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from ..errors import RecordingError, nearest, printable
from .binary_process import BinaryFile, opened
from .columns import EVERY, Choice, Heading
from .table import Table

FORMATS = {".nc": "netCDF", ".mat": "MATLAB", ".parquet": "Parquet"}
NUMBER = np.dtype(float).itemsize
VERSION_7_3 = b"MATLAB 7.3 MAT-file"


def too_large(most: int) -> str:
    """What is wrong with a recording of more bytes than `most`, and the way out."""
    return f'more than {most}; keep fewer rows or columns, or raise the limit, as memory = "2 GiB"'


def read_binary(path: Path, choice: Choice, most: int) -> Table:
    """Table of a file with a suffix of `FORMATS`, whose columns have at most `most` bytes.

    Of netCDF: one of our results, variables `component.variable`, or any file over `time`. Of
    MATLAB up to version 7: a field of a struct is `struct.field`. Parquet needs pyarrow, which is
    in the extra `parquet`. Raises `RecordingError` with the file, and the column at fault.
    """
    form = FORMATS[path.suffix.lower()]
    _check(path, form)
    with opened(path, form, most) as file:
        if form == "Parquet":
            headings = [Heading.of(column.name) for column in file.columns]
        else:
            headings = [Heading(c.name, c.name, c.unit) for c in file.columns]
        if not choice.component and "resilin_version" in file.attributes:
            choice = replace(choice, component=_owner(path, headings))
        if form == "netCDF" and choice.component == EVERY:
            choice = replace(choice, component="")
        return _table(path, choice, file, headings, most)


def _check(path: Path, form: str) -> None:
    if form == "Parquet" and find_spec("pyarrow") is None:
        raise RecordingError(
            f'{path}: Parquet needs pyarrow; pip install "resilin[parquet]", or give CSV'
        )
    with path.open("rb") as file:
        if form == "MATLAB" and file.read(len(VERSION_7_3)) == VERSION_7_3:
            raise RecordingError(
                f"{path}: is a MATLAB file of version 7.3; save it with save(..., '-v7'), or as CSV"
            )


def _owner(path: Path, headings: list[Heading]) -> str:
    """The one component whose variables a result of ours holds."""
    owners = {h.name.partition(".")[0] for h in headings if "." in h.name}
    if len(owners) > 1:
        raise RecordingError(
            f'{path}: holds several components; choose one by component = "NAME",'
            " on the command line --with component=NAME;"
            f" {nearest('', owners)}"
        )
    return next(iter(owners), "")


def _table(
    path: Path, choice: Choice, file: BinaryFile, headings: list[Heading], most: int
) -> Table:
    columns = choice.columns_of(path, "columns", headings)
    count = file.columns[columns[0].place].rows
    for column in columns:
        declared = file.columns[column.place]
        where = f"{path}: column {printable(column.heading)!r}"
        if declared.kind not in "fiu":
            raise RecordingError(f"{where} holds values of kind {declared.kind!r}, not numbers")
        if declared.rows != count:
            raise RecordingError(f"{where} has {declared.rows} rows, time has {count}")
    size = count * len(columns) * NUMBER
    if size > most:
        raise RecordingError(
            f"{path}: {count} rows of {len(columns)} columns unpack to {size} bytes,"
            f" {too_large(most)}"
        )
    values = np.empty((count, len(columns)))
    for k, column in enumerate(columns):
        found = file.values(column.place)
        if len(found) != count:
            raise RecordingError(f"{path}: column {printable(column.heading)!r} is cut short")
        values[:, k] = found
    rows = np.arange(1, count + 1)
    return Table(path, columns, values[:, 0], values[:, 1:], rows, "row", file.attributes)
