"""A lock on a file or folder, which ends with the process that holds it."""

from __future__ import annotations

import os
from pathlib import Path


class Lock:
    """Held from `take` to `release`; where the system has no locks, nobody is kept out."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._number: int | None = None

    def take(self, *, sure: bool = False) -> bool:
        """Whether the lock is held now; false where another process holds it.

        Where the system has no locks it counts as held, unless it has to be `sure`. Raises
        `OSError` where the path cannot be opened.
        """
        try:
            import fcntl
        except ImportError:
            return not sure
        number = os.open(self._path, os.O_RDONLY)
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(number)
            return False
        except OSError:  # a file system without locks
            if sure:
                os.close(number)
                return False
        self._number = number
        return True

    def release(self) -> None:
        """Let others take it; safe to call twice."""
        if self._number is not None:
            os.close(self._number)
            self._number = None

    def __del__(self) -> None:
        self.release()
