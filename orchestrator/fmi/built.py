"""Which FMU files have been built here: only those run inside the master unless a scenario asks.

What an FMU says of its origin anybody can write. The builder notes the SHA-256 of each file that
it makes in a list of the user's own, outside of any folder that comes with a scenario.
"""

from __future__ import annotations

import functools
import hashlib
import os
from pathlib import Path

from ..errors import FmuError


def ledger() -> Path:
    """The list of digests, one a line, in the user's folder for the state of programs."""
    given = Path(os.environ.get("XDG_STATE_HOME", ""))
    home = given if given.is_absolute() else Path("~/.local/state").expanduser()
    return home / "resilin" / "built"


def digest_of(path: Path) -> str:
    """SHA-256 of a file; `FmuError` where it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise FmuError(f"{path}: cannot be read ({error.strerror})") from None


def is_built_here(digest: str) -> bool:
    """Whether a file of this digest has been built by this user on this machine."""
    path = ledger()
    try:
        stat = path.stat()
    except OSError:
        return False
    return digest in _noted(path, stat.st_mtime_ns, stat.st_size)


def note(path: Path) -> None:
    """Note a file that has just been built; `OSError` where the list cannot be written."""
    digest = digest_of(path)
    if is_built_here(digest):
        return
    file = ledger()
    file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    with file.open("a", encoding="ascii") as lines:
        lines.write(f"{digest}\n")


@functools.lru_cache(maxsize=1)
def _noted(path: Path, changed: int, size: int) -> frozenset[str]:
    del changed, size
    try:
        return frozenset(path.read_text(encoding="ascii", errors="replace").split())
    except OSError:
        return frozenset()
