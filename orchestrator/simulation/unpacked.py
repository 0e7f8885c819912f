"""Folders with the content of FMUs: for one run, or kept for the next ones of a study."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import FmuError
from ..fmi.archive import extract
from ..fmi.built import digest_of
from .scratch import Scratch


@dataclass
class _Kept:
    """Folders by the digest of what is in them, while anybody wants them kept."""

    wanted: int = 0
    folders: dict[str, Scratch] = field(default_factory=dict)
    lock: threading.Lock = field(default_factory=threading.Lock)


_KEPT = _Kept()


@contextmanager
def kept_folders() -> Iterator[None]:
    """Inside, an FMU of this project that has been unpacked stays so for the next run."""
    keep_folders()
    try:
        yield
    finally:
        with _KEPT.lock:
            _KEPT.wanted -= 1
            left = [] if _KEPT.wanted else list(_KEPT.folders.values())
            if not _KEPT.wanted:
                _KEPT.folders.clear()
        for folder in left:
            folder.remove()


def keep_folders() -> None:
    """From here on to the end of this process, as a worker does."""
    with _KEPT.lock:
        _KEPT.wanted += 1


@contextmanager
def unpacked(path: Path, digest: str, *, keep: bool) -> Iterator[Path]:
    """Folder with the content of an FMU, which has to be the one with this SHA-256.

    With `keep` it is one for all runs while folders are kept: for FMUs that write nothing into it.
    Raises `FmuError` where the file has changed, or cannot be unpacked.
    """
    if not (keep and _KEPT.wanted):
        with Scratch(path) as folder:
            yield _filled(path, digest, folder)
        return
    with _KEPT.lock:
        if digest not in _KEPT.folders or digest_of(path) != digest:
            with ExitStack() as stack:
                scratch = Scratch(path)
                _filled(path, digest, stack.enter_context(scratch))
                stack.pop_all()
            _KEPT.folders[digest] = scratch
        place = _KEPT.folders[digest].path
    yield place


def _filled(path: Path, digest: str, folder: Path) -> Path:
    extract(path, folder)
    if digest_of(path) != digest:
        raise FmuError(f"{path}: has changed since the scenario was loaded; load it again")
    return folder
