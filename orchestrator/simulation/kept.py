"""Things that are kept by key while anybody wants them: processes and folders between runs."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Generic, TypeVar

Thing = TypeVar("Thing")


class Kept(Generic[Thing]):
    """What is kept by key; `end` is called with each thing that nobody wants any more.

    `things` is to be read and changed under `lock`, and only while it is `wanted`.
    """

    def __init__(self, end: Callable[[Thing], None]) -> None:
        self.things: dict[Any, Thing] = {}
        self.lock = threading.Lock()
        self._end = end
        self._wanted = 0

    @property
    def wanted(self) -> bool:
        """Whether anybody wants things kept."""
        return self._wanted > 0

    def keep(self) -> None:
        """From here on to the end of this process, as a worker does."""
        with self.lock:
            self._wanted += 1

    @contextmanager
    def inside(self) -> Iterator[None]:
        """Inside, things are kept; afterwards, unless somebody else wants them, they end."""
        self.keep()
        try:
            yield
        finally:
            left: list[Thing] = []
            with self.lock:
                self._wanted -= 1
                if not self._wanted:
                    left = list(self.things.values())
                    self.things.clear()
            for thing in left:
                self._end(thing)
