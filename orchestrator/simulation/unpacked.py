"""Folders with the content of FMUs: for one run, or kept for the next ones of a study."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from ..errors import FmuError
from ..fmi.archive import extract
from ..fmi.built import digest_of
from .kept import Kept
from .scratch import Scratch

FOLDERS: Kept[Scratch] = Kept(Scratch.remove)
"""Unpacked FMUs of this project, by their digest."""


@contextmanager
def unpacked(path: Path, digest: str, *, keep: bool) -> Iterator[Path]:
    """Folder with the content of an FMU, which has to be the one with this SHA-256.

    With `keep` it is one for all runs while folders are kept: for FMUs that write nothing into it.
    Raises `FmuError` where the file has changed, or cannot be unpacked.
    """
    if not (keep and FOLDERS.wanted):
        with Scratch(path) as folder:
            yield _filled(path, digest, folder)
        return
    with FOLDERS.lock:
        if digest not in FOLDERS.things or digest_of(path) != digest:
            with ExitStack() as stack:
                scratch = Scratch(path)
                _filled(path, digest, stack.enter_context(scratch))
                stack.pop_all()
            FOLDERS.things[digest] = scratch
        place = FOLDERS.things[digest].path
    yield place


def _filled(path: Path, digest: str, folder: Path) -> Path:
    extract(path, folder)
    if digest_of(path) != digest:
        raise FmuError(f"{path}: has changed since the scenario was loaded; load it again")
    return folder
