"""Files that appear under their name whole, or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import OutputError

FULL = 1 << 16
"""Bytes that are free on a disk that counts as full."""


@contextmanager
def written_whole(
    path: Path, *, durable: bool = False, failures: tuple[type[Exception], ...] = ()
) -> Iterator[Path]:
    """A path beside `path` to write to, which takes its name once the block has ended.

    Where the block fails, an earlier file at `path` is kept and no other file is left.
    With `durable` the content and the name are on the disk when this returns. Raises
    :class:`OutputError` with path and reason on an `OSError`, or on one of the `failures`, the
    errors of the library that writes the format.
    """
    caught: tuple[type[Exception], ...] = (OSError, *failures)
    waiting = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield waiting
        if durable:
            _synchronise(waiting)
        waiting.replace(path)
        if durable:
            _synchronise(path.parent)
    except caught as error:
        raise OutputError(f"{path}: cannot be written ({_reason(error, path.parent)})") from None
    finally:
        if path.parent.is_dir():
            waiting.unlink(missing_ok=True)


def _reason(error: Exception, folder: Path) -> str:
    """Why a file cannot be written; netCDF calls a full disk an error of HDF, or of permission."""
    with suppress(OSError):
        if shutil.disk_usage(folder).free < FULL:
            return "the disk is full"
    return str(getattr(error, "strerror", None) or error)


def _synchronise(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    try:
        number = os.open(path, os.O_RDONLY)
    except OSError:
        if path.is_dir():
            return
        raise
    try:
        os.fsync(number)
    finally:
        os.close(number)
