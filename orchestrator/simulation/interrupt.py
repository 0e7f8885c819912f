"""Ctrl-C, SIGTERM and a closed terminal as a flag, so that a run ends between two steps."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any, Self

SIGNALS = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]

ALARM: signal.Signals | None = getattr(signal, "SIGALRM", None)


class Interrupted(Exception):
    """The user or the system asked the run to stop; `exit_code` is 128 + signal."""

    def __init__(self, number: int) -> None:
        super().__init__(f"stopped by {signal.Signals(number).name}")
        self.exit_code = 128 + number


GRACE = 2.0
"""Seconds after a signal in which a run gets to its next communication point by itself."""


class Interrupt:
    """Context in which SIGINT, SIGTERM and SIGHUP set a flag that a run looks at between steps.

    A second signal, or `GRACE` seconds without a look, raises :class:`Interrupted` wherever the run
    is, as in a call of an instance that hangs. Once it has been raised, and amid `withheld`, no
    signal acts: nothing cuts short how a run ends and is written.
    """

    def __init__(self) -> None:
        self.number = 0
        self._before: dict[int, Any] = {}
        self._withheld = False

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in SIGNALS:
                if signal.getsignal(number) is not signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._note)
            if ALARM is not None:
                self._before[ALARM] = signal.signal(ALARM, self._act)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._before:
            _set_alarm(0.0)
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.number:
            self._act(number, frame)
        else:
            self.number = number
            _set_alarm(GRACE)

    def _act(self, number: int, frame: FrameType | None) -> None:
        if self.number and not self._withheld:
            self.check()

    @contextmanager
    def withheld(self) -> Iterator[None]:
        """While a result is written."""
        before, self._withheld = self._withheld, True
        try:
            yield
        finally:
            self._withheld = before

    def check(self) -> None:
        """Raise :class:`Interrupted` if a signal has come."""
        if self.number:
            self._withheld = True
            _set_alarm(0.0)
            raise Interrupted(self.number)


def _set_alarm(seconds: float) -> None:
    """Have `ALARM` sent after this time; 0 takes that back."""
    if ALARM is not None:
        signal.setitimer(signal.ITIMER_REAL, seconds)
