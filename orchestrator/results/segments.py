"""Rows of a long run on disk in closed pieces: a killed run loses at most the last one.

Each segment is a netCDF file, compressed and checksummed, flushed to disk and renamed when
whole; `manifest.json` lists them with their SHA-256. At the end they become one file, piece by
piece, so memory stays bounded however long the run.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, OutputError
from ..report.files import written_whole
from .lock import Lock
from .texts import Change, Texts, texts_at

Values = NDArray[np.float64]
MANIFEST = "manifest.json"
CACHE = 1 << 20
"""Bytes that netCDF may keep of each variable; its default is 16 MB for each."""
CODED: dict[str, Any] = {"zlib": True, "complevel": 1, "fletcher32": True}


@dataclass(frozen=True)
class Column:
    """A variable of a result: its name in the file and its attributes; `changes` where a text."""

    name: str
    attributes: Mapping[str, Any]
    changes: Sequence[Change] | None = None


class Segments:
    """Closed pieces of one run in a folder, made when the first one is written.

    `texts` are noted with each piece: those that the columns of texts show.
    """

    def __init__(
        self,
        folder: Path,
        columns: Sequence[Column],
        attributes: Mapping[str, Any],
        texts: Texts | None = None,
    ) -> None:
        self.folder = folder
        self.columns = list(columns)
        self.attributes = dict(attributes)
        self.digests: dict[str, str] = {}
        self.texts = texts or Texts(())
        self.rows = 0
        self.lock = Lock(folder)

    def __bool__(self) -> bool:
        return bool(self.digests)

    def write(self, times: Values, rows: Values) -> None:
        """Close one more segment; `OutputError` where the disk does not take it.

        Whatever stops it, the segments before it stay as they are, and none is left half.
        """
        name = f"{len(self.digests):06d}.nc"
        path = self.folder / name
        if not self.digests:
            self._claim()
        try:
            with written_whole(path, durable=True, failures=(RuntimeError,)) as waiting:
                _write_piece(waiting, times, rows)
                digest = _digest(waiting)
            self._note({**self.digests, name: digest})
        except BaseException:  # a signal too: its rows are still in memory
            path.unlink(missing_ok=True)
            if not self.digests:
                self.remove()
            raise
        self.digests[name] = digest
        self.rows += len(times)

    def _claim(self) -> None:
        """Make the folder, and hold it while this process lives."""
        try:
            self.folder.mkdir(parents=True)
            self.lock.take()
        except FileExistsError:
            raise taken(self.folder) from None
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be made ({error.strerror})") from None

    def _note(self, digests: Mapping[str, str]) -> None:
        """Bring the manifest up to date; the file is whole at any time."""
        columns = [[c.name, dict(c.attributes), c.changes] for c in self.columns]
        text = json.dumps({"segments": digests, "columns": columns, "attributes": self.attributes})
        with written_whole(self.folder / MANIFEST) as waiting:
            waiting.write_text(text, encoding="utf-8")

    def pieces(self) -> Iterator[tuple[Values, Values]]:
        """Times and rows of each segment, checked against its digest."""
        for name in self.digests:
            if not self.is_whole(name):
                raise InputError(
                    f"{self.folder / name}: is not what was written; its rows are lost"
                )
            yield _read_piece(self.folder / name)

    def is_whole(self, name: str) -> bool:
        """Whether a segment is there, as it was written."""
        path = self.folder / name
        try:
            return path.is_file() and _digest(path) == self.digests[name]
        except OSError:
            return False

    def remove(self) -> None:
        """Remove the folder, once its rows are elsewhere."""
        self.lock.release()
        shutil.rmtree(self.folder, ignore_errors=True)


def taken(folder: Path) -> OutputError:
    """What is wrong where the folder for the segments of a run is there before it."""
    return OutputError(
        f"{folder}: holds the rows of another run; if that one is over,"
        f" `resilin recover {folder}` makes a file of them"
    )


def clear_of_nothing(folder: Path) -> None:
    """Remove what a run has left that was killed before its first segment was whole."""
    if (folder / MANIFEST).exists() or not folder.is_dir():
        return
    lock = Lock(folder)
    try:
        if lock.take(sure=True):
            shutil.rmtree(folder, ignore_errors=True)
    except OSError:
        return
    finally:
        lock.release()


def folder_of(path: Path) -> Path:
    """Where the segments of a result go while the run lasts."""
    return path.with_name(path.name.removesuffix(".nc") + ".segments")


def found(folder: Path) -> Segments:
    """Segments that a killed run has left, held by this process.

    Raises `InputError` where there are none, and where their run is alive.
    """
    lock = Lock(folder)
    try:
        if not lock.take():
            raise InputError(f"{folder}: its run is still alive; stop it first, or let it end")
        if not (folder / MANIFEST).exists():
            raise InputError(
                f"{folder}: no segments of a run here: it was killed before the first was whole;"
                " the next run of this name takes its place"
            )
        known = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        columns = [Column(*column) for column in known["columns"]]
        segments = Segments(folder, columns, known["attributes"])
        segments.digests = dict(known["segments"])
        segments.lock = lock
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        lock.release()
        raise InputError(f"{folder}: no segments of a run here ({error})") from None
    return segments


def assemble(
    path: Path,
    columns: Sequence[Column],
    attributes: Mapping[str, Any],
    pieces: Iterator[tuple[Values, Values]],
) -> None:
    """One labelled netCDF file from pieces of rows, written in place piece by piece."""
    import netCDF4

    netCDF4.set_chunk_cache(CACHE)
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(dict(attributes))
        file.createDimension("time", None)
        chunk = (4096,)
        time = file.createVariable("time", "f8", ("time",), chunksizes=chunk, **CODED)
        time.setncatts({"units": "s", "long_name": "Time at which values hold"})
        numbers, texts = [], []
        for column in columns:
            if column.changes is not None:
                variable = file.createVariable(column.name, str, ("time",), chunksizes=chunk)
                variable.setncatts(dict(column.attributes))
                texts.append((variable, column.changes))
                continue
            variable = file.createVariable(
                column.name, "f8", ("time",), chunksizes=chunk, fill_value=np.nan, **CODED
            )
            variable.setncatts(dict(column.attributes))
            numbers.append(variable)
        first = 0
        for times, rows in pieces:
            last = first + len(times)
            time[first:last] = times
            for k, variable in enumerate(numbers):
                variable[first:last] = rows[:, k]
            for variable, changes in texts:
                variable[first:last] = texts_at(changes, times)
            first = last


def _write_piece(path: Path, times: Values, rows: Values) -> None:
    import netCDF4

    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", len(times))
        file.createDimension("column", rows.shape[1])
        file.createVariable("time", "f8", ("time",), **CODED)[:] = times
        file.createVariable("rows", "f8", ("time", "column"), **CODED)[:] = rows


def _read_piece(path: Path) -> tuple[Values, Values]:
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        return np.asarray(file["time"][:]), np.asarray(file["rows"][:])


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
