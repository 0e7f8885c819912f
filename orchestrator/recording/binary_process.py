"""A binary file behind a process of its own, which a damaged file may crash, hang or fill.

The libraries that read netCDF, MATLAB and Parquet are written for good files: of damaged ones they
raise anything, read beyond their memory, or unpack gigabytes.
"""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from ..errors import RecordingError, printable
from .table import Values

READER = Path(__file__).with_name("binary_reader.py")
PATIENCE = 120.0
"""Seconds that a reader may take for one file."""
LONGEST = 1 << 26
"""Bytes that the description of a file may have."""


@dataclass(frozen=True)
class Declared:
    """What a file says of a vector before it is read; `kind` is that of its dtype, `U` of texts."""

    name: str
    unit: str
    rows: int
    kind: str


class BinaryFile:
    """An open file: numeric `columns`, `texts` and `attributes` as declared, and their values."""

    def __init__(self, path: Path, form: str, lines: IO[bytes], answers: IO[bytes]) -> None:
        self._where = f"{path}: cannot be read as a {form} file"
        self._path = path
        self._lines = lines
        self._answers = answers
        found = self._answer(self._where)
        self.columns = [Declared(**column) for column in found["columns"]]
        self.texts = [Declared(**column) for column in found["texts"]]
        self.attributes: dict[str, str] = found["attributes"]

    def values(self, k: int) -> Values:
        """Values of a column; `RecordingError` where they cannot be read."""
        return self._values(k, self.columns[k].name)[1]

    def changes(self, k: int) -> list[tuple[int, str]]:
        """Rows at which a text changes, and the text from there on, as :meth:`values`."""
        found, rows = self._values(len(self.columns) + k, self.texts[k].name)
        return [(int(row), text) for row, text in zip(rows, found["texts"], strict=True)]

    def _values(self, place: int, name: str) -> tuple[dict[str, Any], Values]:
        where = f"{self._path}: {printable(name)!r} cannot be read"
        try:
            self._lines.write(b"%d\n" % place)
            self._lines.flush()
        except OSError:
            raise RecordingError(f"{where} (its reader crashed or took too long)") from None
        found = self._answer(where)
        size = found["rows"] * np.dtype(float).itemsize
        content = self._answers.read(size)
        if len(content) != size:
            raise RecordingError(f"{where} (its reader crashed or took too long)")
        return found, np.frombuffer(content)

    def _answer(self, where: str) -> dict[str, Any]:
        line = self._answers.readline(LONGEST)
        if not line.endswith(b"\n"):
            raise RecordingError(f"{where} (its reader crashed or took too long)")
        found: dict[str, Any] = json.loads(line)
        if "refused" in found:
            raise RecordingError(f"{where} ({printable(' '.join(found['refused'].split()))})")
        return found


@contextmanager
def opened(path: Path, form: str, most: int) -> Iterator[BinaryFile]:
    """A file of a format, whose reader may unpack `most` bytes.

    Raises `RecordingError` where it cannot be read.
    """
    with _reader(path, form, most) as (lines, answers):
        yield BinaryFile(path, form, lines, answers)


@contextmanager
def _reader(path: Path, form: str, most: int) -> Iterator[tuple[IO[bytes], IO[bytes]]]:
    """Standard input and output of a process that reads a file, killed at the end."""
    command = [sys.executable, "-P", "-W", "ignore"]
    command += [str(READER), form, str(path.absolute()), str(most)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL) as process:
        watch = threading.Timer(PATIENCE, process.kill)
        watch.start()
        try:
            assert process.stdin is not None and process.stdout is not None
            yield process.stdin, process.stdout
        finally:
            watch.cancel()
            process.kill()
