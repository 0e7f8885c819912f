"""Files that appear under their name whole, or not at all; and whether they can appear there."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import OutputError

FULL = 1 << 16
"""Bytes that are free on a disk that counts as full."""


def check_place(path: Path, kind: str = "", endings: Collection[str] = ()) -> None:
    """Raise `OutputError` where no file can be written to `path`; nothing is made there.

    `kind` says what files of this kind are, as `pages are HTML files`, and `endings` what they end
    with.
    """
    if endings and path.suffix.lower() not in endings:
        raise OutputError(f"{path}: {kind}; name it {' or '.join(f'*{end}' for end in endings)}")
    try:
        if path.is_dir():
            raise OutputError(f"{path}: is a folder; name a file")
        folder = next(above for above in path.parents if above.exists())
    except (OSError, ValueError) as error:
        raise OutputError(_not_made(path, error)) from None
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        if folder == path.parent and folder.is_dir():
            raise OutputError(f"{folder}: not writable ({error.strerror})") from None
        raise OutputError(_not_made(path, error)) from None


def _not_made(path: Path, error: Exception) -> str:
    reason = getattr(error, "strerror", None) or error
    return f"{path.parent}: cannot be made for {path} ({reason})"


def make_folder(path: Path) -> None:
    """Make the folder of a file."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(_not_made(path, error)) from None


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
