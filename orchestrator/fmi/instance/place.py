"""Where an instance is, in memory that a second process sees: the call, its time, and how many.

It is written before and after each call of an FMU, by Python and by the compiled loop alike, and
read by a process that watches: what was asked of an FMU that crashed or hangs stands there.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import ClassVar

SEND, STEP, RECEIVE_FIRST, RECEIVE, SAVE, RESTORE, FORGET, REFUSED, BEYOND = range(9)
"""Calls of an instance, as `loop.h` of the compiled loop numbers them."""
INSTANTIATE, PREPARE, SET, ENTER, EXIT, CLOSE = range(9, 15)

WORDS = {
    SEND: "setting inputs",
    RECEIVE_FIRST: "reading outputs",
    RECEIVE: "reading outputs",
    SAVE: "saving its state",
    RESTORE: "going back to a state",
    FORGET: "freeing a state",
    INSTANTIATE: "instantiating",
    PREPARE: "setting start values",
    SET: "setting parameters",
    ENTER: "entering initialisation",
    EXIT: "leaving initialisation",
    CLOSE: "closing",
}


class Place(ctypes.Structure):
    """The place of one instance. `turns` is odd amid a call.

    `steps` and `rollbacks` count those begun; `time` and `size` are those of the last step [s].
    """

    _fields_: ClassVar = [
        ("turns", ctypes.c_int64),
        ("steps", ctypes.c_int64),
        ("rollbacks", ctypes.c_int64),
        ("time", ctypes.c_double),
        ("size", ctypes.c_double),
        ("call", ctypes.c_int32),
    ]

    turns: int
    steps: int
    rollbacks: int
    time: float
    size: float
    call: int

    @contextmanager
    def at(self, call: int) -> Iterator[None]:
        """Amid a call of the FMU."""
        self.call = call
        self.turns += 1
        try:
            yield
        finally:
            self.turns += 1

    @property
    def busy(self) -> bool:
        """Whether the instance is amid a call."""
        return self.turns % 2 == 1

    def __str__(self) -> str:
        if self.call == STEP:
            return step_text(self.time, self.size)
        return WORDS.get(self.call, "working")


def step_text(time: float, size: float) -> str:
    """A step in words."""
    return f"step from t = {time:.9g} s by {size:.4g} s"
