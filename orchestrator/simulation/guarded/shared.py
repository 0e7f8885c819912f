"""What a run and the process that watches it both see: the places of the instances, and the rows.

Both stand in files without a name. What has been written before the run's process died is there
to be read, and nothing that it wrote is ever executed.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import tempfile
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...fmi.instance.place import Place
from ..observers import Memory

Values = NDArray[np.float64]
DOUBLE = 8


class Header(ctypes.Structure):
    """`stop` is the signal that the run is to end by, `begun` the time at which it began to step.

    The time is that of `perf_counter` [s], which all processes share; it is 0 before. `probing` is
    1 while FMUs are tried.
    """

    _fields_: ClassVar = [
        ("stop", ctypes.c_int64),
        ("probing", ctypes.c_int64),
        ("begun", ctypes.c_double),
    ]

    stop: int
    probing: int
    begun: float


@dataclass(frozen=True)
class Files:
    """Descriptors of the files that both processes have open."""

    board: int
    times: int
    rows: int

    @classmethod
    def made(cls) -> Files:
        """New files."""
        return cls(*(_nameless() for _ in range(3)))

    def clear(self, instances: int) -> None:
        """Empty all, with a board for so many instances: for the next run."""
        for descriptor in (self.board, self.times, self.rows):
            os.ftruncate(descriptor, 0)
        os.ftruncate(self.board, _board_size(instances))

    def close(self) -> None:
        """Close all; they are gone once the other process has ended too."""
        for descriptor in (self.board, self.times, self.rows):
            os.close(descriptor)


def _nameless() -> int:
    """A file that is gone when nobody has it open any more; in memory where the system can."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create("resilin")
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())


def _board_size(instances: int) -> int:
    return ctypes.sizeof(Header) + instances * ctypes.sizeof(Place)


class Board:
    """Header and places, mapped into this process."""

    def __init__(self, descriptor: int, instances: int) -> None:
        memory = mmap.mmap(descriptor, _board_size(instances))
        self.header = Header.from_buffer(memory)
        self.places: list[Place] = list(
            (Place * instances).from_buffer(memory, ctypes.sizeof(Header))
        )


class SharedRows(Memory):
    """Rows in files, for the process that writes them. A row is whole once its time stands."""

    def __init__(self, made: Files) -> None:
        self._files = made

    def extended(self, times: Values, rows: Values, length: int) -> tuple[Values, Values]:
        width = rows.shape[1]
        longer = self._mapped(self._files.times, length)
        longer[len(times) :] = np.nan
        return longer, self._mapped(self._files.rows, length * width).reshape(length, width)

    def _mapped(self, descriptor: int, count: int) -> Values:
        size = DOUBLE * max(1, count)
        os.ftruncate(descriptor, size)
        return np.frombuffer(mmap.mmap(descriptor, size), count=count)


def written(made: Files, width: int) -> tuple[Values, Values]:
    """Copies of the times and rows that are whole, for the process that watches."""
    times = _read(made.times)
    missing = np.flatnonzero(np.isnan(times))
    count = int(missing[0]) if len(missing) else len(times)
    rows = _read(made.rows, count * width)
    if width:
        count = min(count, len(rows) // width)
    return times[:count], rows[: count * width].reshape(count, width)


def discard(made: Files) -> None:
    """Take the rows away, once they are elsewhere: no time stands any more."""
    count = os.fstat(made.times).st_size // DOUBLE
    os.pwrite(made.times, np.full(count, np.nan).tobytes(), 0)


def _read(descriptor: int, most: int = -1) -> Values:
    """The numbers of a file, at most so many of them."""
    with os.fdopen(os.dup(descriptor), "rb") as file:
        file.seek(0)
        return np.fromfile(file, count=most)
