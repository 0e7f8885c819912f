"""FMI 3.0 for co-simulation.

Instances are made without event mode and early return, so an FMU handles its events inside its
step, as FMI 3 then demands. One that requests event mode, returns early or requests the end all
the same is refused with that reason.
"""

from __future__ import annotations

import ctypes
import functools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ...errors import InstanceFailure
from ..description import Variable
from .buffers import DTYPES
from .in_process import InProcessInstance, listen, route
from .place import step_text

POINTER = ctypes.c_void_p
DOUBLE = ctypes.c_double
COUNT = ctypes.c_size_t
FLAG = ctypes.c_bool
TEXT = ctypes.c_char_p


class Fmi3Instance(InProcessInstance):
    """An instance of an FMI 3.0 FMU."""

    PREFIX = "fmi3"
    dtypes: ClassVar = {**DTYPES, "Boolean": np.bool_, "Enumeration": np.int64}
    SUFFIX: ClassVar = {"Enumeration": "Int64"}

    def _instantiate(self, folder: Path) -> Any:
        from fmpy.fmi3 import fmi3LogMessageCallback

        instantiate = self._function(
            "fmi3InstantiateCoSimulation",
            *(TEXT, TEXT, TEXT, FLAG, FLAG, FLAG, FLAG, POINTER, COUNT, POINTER),
            *(fmi3LogMessageCallback, POINTER),
            result=POINTER,
        )
        self._do_step = self._function("fmi3DoStep", POINTER, DOUBLE, DOUBLE, FLAG, *4 * [POINTER])
        self._event = ctypes.c_bool()
        self._terminate = ctypes.c_bool()
        self._early = ctypes.c_bool()
        self._reached = ctypes.c_double()
        results = (self._event, self._terminate, self._early, self._reached)
        self._flags = tuple(ctypes.addressof(entry) for entry in results)
        resources = folder / "resources"
        return instantiate(
            self.name.encode(),
            self.interface.guid.encode(),
            (str(resources.resolve()) + os.sep).encode() if resources.is_dir() else None,
            *(False, True, False, False),
            *(None, 0),
            listen(self),
            _logger(),
            None,
        )

    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        self._set_starts(start)
        self._span = (tolerance, time, stop)
        self._now = time

    def enter_initialisation(self) -> None:
        tolerance, time, stop = self._span
        enter = self._function(
            "fmi3EnterInitializationMode", POINTER, FLAG, DOUBLE, DOUBLE, FLAG, DOUBLE
        )
        accuracy = (tolerance is not None, tolerance or 0.0)
        self._call(enter, *accuracy, time, stop is not None, stop or 0.0)

    def exit_initialisation(self) -> None:
        self._call(self._function("fmi3ExitInitializationMode", POINTER))
        self.faults = 0
        self._running = True

    def _transfer_function(self, verb: str, kind: str) -> Any:
        name = f"fmi3{verb}{self.SUFFIX.get(kind, kind)}"
        return self._function(name, POINTER, POINTER, COUNT, POINTER, COUNT)

    def _bind(self, verb: str, kind: str, references: list[int], values: Any) -> Callable[[], int]:
        count, total = len(references), len(values)
        raw = self._transfer_function(verb, kind)
        wanted = (ctypes.c_uint * count)(*references)
        instance = self._instance
        there = ctypes.addressof(wanted)
        pointer = values.ctypes.data
        keep = (wanted, values)

        def call() -> int:
            return int(raw(instance, there, count, pointer, total) if keep else 0)

        return call

    def _set_text(self, variable: Variable, text: str) -> None:
        set_string = self._function("fmi3SetString", POINTER, POINTER, COUNT, POINTER, COUNT)
        reference = (ctypes.c_uint * 1)(variable.reference)
        values = (ctypes.c_char_p * 1)(text.encode())
        self._call(set_string, ctypes.addressof(reference), 1, ctypes.addressof(values), 1)

    def _advance(self, time: float, size: float) -> int:
        final = not self._returns(time, size)
        status = int(self._do_step(self._instance, time, size, final, *self._flags))
        if status in (0, 1):
            self._refuse(time, size)
        return status

    def _refuse(self, time: float, size: float) -> None:
        """`InstanceFailure` where the step requests the end or event mode, or returned early."""
        where = f"{self.name}: {step_text(time, size)}"
        if self._terminate.value:
            raise InstanceFailure(
                f"{where}: the FMU requests the end of the simulation{self.last_message()}"
            )
        if self._early.value:
            raise InstanceFailure(
                f"{where}: the FMU returned early, at t = {self._reached.value:.9g} s, which it"
                " was not allowed to do; export it without early return"
            )
        if self._event.value:
            raise InstanceFailure(
                f"{where}: the FMU requests event mode, which it was not given; export it so"
                " that it handles its events inside a step"
            )

    def _state_function(self, verb: str) -> Any:
        return self._function(f"fmi3{verb}FMUState", POINTER, POINTER)


@functools.cache
def _logger() -> Any:
    """The one callback of all instances, kept until the process ends."""
    from fmpy.fmi3 import fmi3LogMessageCallback

    return fmi3LogMessageCallback(_log)


def _log(environment: int | None, status: int, category: bytes, message: bytes | None) -> None:
    """Logger of all instances of FMI 3."""
    route(environment, status, message)
