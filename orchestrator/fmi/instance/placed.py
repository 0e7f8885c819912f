"""Instances that note in shared memory which call of their FMU they are in."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from ..description import Interface, Variable
from . import kind_of
from .base import Values
from .in_process import InProcessInstance
from .message_log import FAULTY, MOST_MESSAGES
from .place import (
    CLOSE,
    ENTER,
    EXIT,
    FORGET,
    INSTANTIATE,
    PREPARE,
    RECEIVE,
    RESTORE,
    SAVE,
    SEND,
    SET,
    STEP,
    Place,
)

PassOn = Callable[[int, str], None]


class _Placed(InProcessInstance):
    """An instance of this process whose calls are noted in `place`, and its messages passed on."""

    place: Place

    def __init__(
        self, name: str, interface: Interface, folder: Path, place: Place, pass_on: PassOn
    ) -> None:
        self.place = place
        self._pass_on = pass_on
        with place.at(INSTANTIATE):
            super().__init__(name, interface, folder)

    def log(self, status: int, message: str) -> None:
        super().log(status, message)
        if message and (self.message_count < MOST_MESSAGES or status in FAULTY):
            self._pass_on(status, message)

    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        with self.place.at(PREPARE):
            super().prepare(start, time, stop, tolerance)  # type: ignore[safe-super]

    def set(self, start: dict[str, float | str]) -> None:
        with self.place.at(SET):
            super().set(start)

    def enter_initialisation(self) -> None:
        with self.place.at(ENTER):
            super().enter_initialisation()  # type: ignore[safe-super]

    def exit_initialisation(self) -> None:
        with self.place.at(EXIT):
            super().exit_initialisation()  # type: ignore[safe-super]

    def send(self) -> None:
        with self.place.at(SEND):
            super().send()

    def step(self, time: float, size: float) -> None:
        place = self.place
        place.time, place.size = time, size
        place.steps += 1
        with place.at(STEP):
            super().step(time, size)

    def receive(self, group: int = -1) -> None:
        with self.place.at(RECEIVE):
            super().receive(group)

    def rates(self) -> Values | None:
        with self.place.at(RECEIVE):
            return super().rates()

    def incline(self, rates: Values) -> None:
        with self.place.at(SEND):
            super().incline(rates)

    def texts(self, variables: list[Variable]) -> list[str]:
        with self.place.at(RECEIVE):
            return super().texts(variables)

    def save(self) -> Any:
        with self.place.at(SAVE):
            return super().save()

    def restore(self, state: Any) -> None:
        self.place.rollbacks += 1
        with self.place.at(RESTORE):
            super().restore(state)

    def forget(self, state: Any) -> None:
        with self.place.at(FORGET):
            super().forget(state)

    def close(self) -> None:
        with self.place.at(CLOSE):
            super().close()


@cache
def _placed(kind: type[InProcessInstance]) -> type[_Placed]:
    """A class of instances whose calls are noted."""
    return type(f"Placed{kind.__name__}", (_Placed, kind), {})


def placed_instance(
    name: str, interface: Interface, folder: Path, place: Place, pass_on: PassOn
) -> InProcessInstance:
    """Instance in this process whose calls are noted in `place`.

    `pass_on` gets the status and text of its first messages and of all errors as they come.
    """
    return _placed(kind_of(interface))(name, interface, folder, place, pass_on)
