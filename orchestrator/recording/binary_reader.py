"""The process that reads one binary file: `python binary_reader.py FORMAT FILE BYTES`.

It writes a line of JSON: what the file declares of each vector of numbers and of texts, and its
attributes; or why it cannot be read. Then it answers each line with the place of a column by a line
of JSON, followed by the values as doubles. Places of texts come after those of numbers; their
values are the rows at which they change, and the line has the texts. It imports nothing of this
package, so that it starts as fast as the library that reads the format does.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np

COPIES = 2
"""Times that a reader holds what it unpacks: as it was written, and as an array."""
ROOM = 512 << 20
"""Bytes for the reader itself."""
SECONDS = 8
"""Processor time for a small file; a damaged one may be read for ever."""
SLOWEST = 10 << 20
"""Bytes of a file that a reader takes in a second at least."""

Columns = list[dict[str, Any]]
Found = tuple[Columns, Columns, dict[str, str], Callable[[int], Any]]
"""Declared numbers and texts, attributes of the file, and how the values of a column are read."""


def serve(form: str, path: str, lines: IO[bytes], answers: IO[bytes]) -> None:
    """Describe a file and send the columns that are asked for, until there is no more line."""
    try:
        columns, texts, attributes, read = READERS[form](path)
    except BaseException as error:
        _answer(answers, {"refused": _reason(error)})
        return
    _answer(answers, {"columns": columns, "texts": texts, "attributes": attributes})
    for line in lines:
        try:
            found = read(int(line))
            known, found = _changes(found) if int(line) >= len(columns) else ({}, found)
            values = np.ascontiguousarray(found, dtype=float)
        except BaseException as error:
            _answer(answers, {"refused": _reason(error)})
            continue
        _answer(answers, {"rows": len(values), **known}, values.tobytes())


def _changes(texts: list[str]) -> tuple[dict[str, Any], list[int]]:
    """The texts at the rows where they change, and these rows."""
    rows = [k for k, text in enumerate(texts) if k == 0 or text != texts[k - 1]]
    return {"texts": [texts[k] for k in rows]}, rows


def _answer(answers: IO[bytes], content: dict[str, Any], values: bytes = b"") -> None:
    answers.write(json.dumps(content).encode() + b"\n" + values)
    answers.flush()


def _reason(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__


def _column(name: str, unit: str, rows: int, kind: str) -> dict[str, Any]:
    return {"name": name, "unit": unit, "rows": rows, "kind": kind}


def read_netcdf(path: str) -> Found:
    """Variables over one dimension; numbers that are missing become NaN."""
    import netCDF4

    file = netCDF4.Dataset(path)
    file.set_always_mask(False)
    numbers: list[tuple[dict[str, Any], Any]] = []
    texts: list[tuple[dict[str, Any], Any]] = []
    for key, variable in file.variables.items():
        kind = "U" if variable.dtype is str else getattr(variable.dtype, "kind", "O")
        if variable.ndim == 1 and kind in "fiuU":
            noted = {name: variable.getncattr(name) for name in variable.ncattrs()}
            name, unit = str(noted.get("original_name", key)), str(noted.get("units", ""))
            declared = _column(name, unit, int(variable.size), kind)
            (texts if kind == "U" else numbers).append((declared, variable))
    columns, variables = [d for d, _ in numbers], [v for _, v in (*numbers, *texts)]
    attributes = {str(name): str(file.getncattr(name)) for name in file.ncattrs()}

    def read(k: int) -> Any:
        if k >= len(columns):
            return [str(text) for text in variables[k][:].tolist()]
        return np.ma.filled(np.ma.asarray(variables[k][:], dtype=float), np.nan)

    return columns, [d for d, _ in texts], attributes, read


def read_matlab(path: str) -> Found:
    """Vectors by name; those in a struct are `struct.field`."""
    from scipy.io import loadmat

    found = list(_vectors(loadmat(path, simplify_cells=True)))
    columns = [_column(name, "", len(values), values.dtype.kind) for name, values in found]
    return columns, [], {}, lambda k: found[k][1]


def _vectors(tree: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if key.startswith("__"):
            continue
        if isinstance(value, dict):
            yield from _vectors(value, f"{prefix}{key}.")
        elif isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "fiu":
            yield prefix + key, value


def read_parquet(path: str) -> Found:
    """All columns; those of other types than numbers are of kind O."""
    from pyarrow import parquet, types

    file = parquet.ParquetFile(path)
    columns = []
    for field in file.schema_arrow:
        number = types.is_integer(field.type) or types.is_floating(field.type)
        columns.append(_column(str(field.name), "", file.metadata.num_rows, "f" if number else "O"))

    def read(k: int) -> Any:
        name = file.schema_arrow.field(k).name
        return file.read([name], use_threads=False).column(0).to_numpy()

    return columns, [], {}, read


READERS: dict[str, Callable[[str], Found]] = {
    "netCDF": read_netcdf,
    "MATLAB": read_matlab,
    "Parquet": read_parquet,
}


def limit(most: int, packed: int) -> None:
    """Limit memory beyond what is in use, and processor time, where the system can; no core files.

    The file has `packed` bytes and may unpack `most`.
    """
    try:
        import resource
    except ImportError:
        return
    if sys.platform == "linux":
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        size = min(pages * resource.getpagesize() + ROOM + COPIES * most, sys.maxsize)
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        if hard == resource.RLIM_INFINITY or size < hard:
            resource.setrlimit(resource.RLIMIT_AS, (size, size))
    seconds = SECONDS + packed // SLOWEST
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    limit(int(sys.argv[3]), Path(sys.argv[2]).stat().st_size)
    serve(sys.argv[1], sys.argv[2], sys.stdin.buffer, sys.stdout.buffer)
