"""netCDF, MATLAB and Parquet: columns by name, rows counted from 1."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import RecordingError, nearest, printable
from .columns import EVERY, Choice, Heading
from .table import Table


def read_netcdf(path: Path, choice: Choice) -> Table:
    """Table of one of our results, variables `component.variable`, or of any file over `time`."""
    import xarray

    try:
        with xarray.open_dataset(path, engine="netcdf4", decode_times=False) as data:
            data.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise RecordingError(f"{path}: cannot be read as a netCDF file ({error})") from None
    headings, columns = [], []
    for key, variable in data.variables.items():
        if variable.ndim == 1 and variable.dtype.kind in "fiu":
            name = str(variable.attrs.get("original_name", key))
            headings.append(Heading(name, name, str(variable.attrs.get("units", ""))))
            columns.append(variable.values)
    attributes = {str(key): str(value) for key, value in data.attrs.items()}
    if not choice.component and "resilin_version" in attributes:
        owners = {h.name.partition(".")[0] for h in headings if "." in h.name}
        if len(owners) > 1:
            raise RecordingError(
                f'{path}: holds several components; choose one by component = "...";'
                f" {nearest('', owners)}"
            )
        choice = replace(choice, component=next(iter(owners), ""))
    if choice.component == EVERY:
        choice = replace(choice, component="")
    return _table(path, choice, headings, columns, attributes)


def read_matlab(path: Path, choice: Choice) -> Table:
    """Table of a .mat file up to version 7; a field of a struct is `struct.field`."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        found = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        raise RecordingError(
            f"{path}: is a MATLAB file of version 7.3; save it with save(..., '-v7'), or as CSV"
        ) from None
    except (MatReadError, OSError, ValueError, TypeError, IndexError, MemoryError) as error:
        reason = printable(str(error))
        raise RecordingError(f"{path}: cannot be read as a MATLAB file ({reason})") from None
    flat = [(name, value) for name, value in _flat(found) if value.size > 1]
    headings = [Heading(name, name, "") for name, _ in flat]
    return _table(path, choice, headings, [value for _, value in flat], {})


def _flat(tree: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if key.startswith("__"):
            continue
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        elif isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "fiu":
            yield prefix + key, value


def read_parquet(path: Path, choice: Choice) -> Table:
    """Table of a Parquet file; needs pyarrow, which comes with the extra `parquet`."""
    try:
        from pyarrow import ArrowException
        from pyarrow.parquet import read_table
    except ImportError:
        raise RecordingError(
            f'{path}: Parquet needs pyarrow; pip install "resilin[parquet]", or give CSV'
        ) from None
    try:
        found = read_table(path)
    except (ArrowException, OSError) as error:
        reason = printable(str(error))
        raise RecordingError(f"{path}: cannot be read as a Parquet file ({reason})") from None
    headings = [Heading.of(str(name)) for name in found.column_names]
    columns = [np.asarray(found.column(k).to_numpy()) for k in range(len(headings))]
    return _table(path, choice, headings, columns, {})


def _table(
    path: Path, choice: Choice, headings: list[Heading], arrays: list[Any], comments: dict[str, str]
) -> Table:
    columns = choice.columns_of(path, "columns", headings)
    for column in columns:
        kind = arrays[column.place].dtype.kind
        if kind not in "fiu":
            raise RecordingError(
                f"{path}: column {printable(column.heading)!r} holds values of kind {kind!r},"
                " not numbers"
            )
    sizes = {column.heading: len(arrays[column.place]) for column in columns}
    count = sizes[columns[0].heading]
    for heading, size in sizes.items():
        if size != count:
            raise RecordingError(
                f"{path}: column {printable(heading)!r} has {size} rows, time has {count}"
            )
    values = np.array([arrays[c.place] for c in columns], dtype=float).reshape(len(columns), -1).T
    return Table(
        path, columns, values[:, 0], values[:, 1:], np.arange(1, count + 1), "row", comments
    )
