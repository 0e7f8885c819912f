"""States for an FMU for model exchange that has none: its continuous states and the time.

What else it keeps, as what a discrete variable is, does not come back. So a step in which an event
has been cannot be undone, and says so.
"""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ...errors import InstanceFailure, printable

if TYPE_CHECKING:
    from .integrated import Integrated

POINTER = ctypes.c_void_p
ERROR = 3


class Restart:
    """Get, set and free of states, as functions that C can call like an FMU's own."""

    def __init__(self, instance: Integrated) -> None:
        self._instance = instance
        self._kept: dict[int, Any] = {}
        self._numbers = itertools.count(1)
        made = ctypes.CFUNCTYPE(ctypes.c_int, POINTER, POINTER)
        given = {"Get": self._get, "Set": self._set, "Free": self._free}
        self._functions: dict[str, Any] = {}
        for verb, call in given.items():
            self._functions[verb] = made(self._safe(call))
            self._functions[verb].__name__ = f"{verb.lower()} of the continuous states"

    def function(self, verb: str) -> Any:
        """Get, Set or Free."""
        return self._functions[verb]

    def _safe(self, call: Callable[[int], None]) -> Callable[[Any, int], int]:
        """What goes wrong as a message and a status: nothing may leave what C calls."""

        def safe(_: Any, where: int) -> int:
            try:
                call(where)
            except InstanceFailure as error:
                self._instance.log(ERROR, str(error).partition(": ")[2])
                return ERROR
            except Exception as error:
                self._instance.log(ERROR, printable(f"{type(error).__name__}: {error}"))
                return ERROR
            return 0

        return safe

    def _get(self, where: int) -> None:
        number = next(self._numbers)
        self._kept[number] = self._instance.here()
        POINTER.from_address(where).value = number

    def _set(self, number: int) -> None:
        time, states, events = self._kept[number]
        if events != self._instance.events:
            raise InstanceFailure(
                f"{self._instance.name}: an event lies in the step that is to be undone, and the"
                " FMU has no states to go back to; rollback = false does without"
            )
        self._instance.begin_at(time, states)

    def _free(self, where: int) -> None:
        self._kept.pop(POINTER.from_address(where).value or 0, None)
