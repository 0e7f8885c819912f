"""Folders for temporary files: removed at the end, or by a later run where a run was killed."""

from __future__ import annotations

import functools
import shutil
import tempfile
import time
from pathlib import Path
from types import TracebackType

from ..errors import FmuError
from ..results.lock import Lock

PREFIX = "resilin-"
FRESH = 60.0
"""Seconds in which a folder without a lock may be one that is just being made."""


class Scratch:
    """A folder that this process holds; a context manager that gives its path.

    What is wrong is said of the file `path`, for which the folder is. Raises `FmuError` where
    there can be none.
    """

    def __init__(self, path: Path) -> None:
        _sweep(tempfile.gettempdir())
        try:
            self._made = tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True)
        except OSError as error:
            raise FmuError(
                f"{path}: no folder for temporary files in {tempfile.tempdir}"
                f" ({error.strerror}); set TMPDIR to one that exists and is writable"
            ) from None
        self.path = Path(self._made.name)
        if "%" in self._made.name:
            self._made.cleanup()
            raise FmuError(
                f"{path}: FMUs do not load from {self.path}; set TMPDIR to one without %"
            )
        self._lock = Lock(self.path)
        self._lock.take()

    def __enter__(self) -> Path:
        return self.path

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.remove()

    def remove(self) -> None:
        """Remove the folder."""
        self._lock.release()
        self._made.cleanup()


@functools.cache
def _sweep(place: str) -> None:
    """Remove, once in a process, what runs that were killed have left: nobody holds it."""
    now = time.time()
    for folder in Path(place).glob(f"{PREFIX}*"):
        lock = Lock(folder)
        try:
            if folder.is_dir() and now - folder.stat().st_mtime > FRESH and lock.take(sure=True):
                shutil.rmtree(folder, ignore_errors=True)
        except OSError:
            continue
        finally:
            lock.release()
