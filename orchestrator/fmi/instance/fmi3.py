"""FMI 3.0, for co-simulation and for model exchange.

Instances for co-simulation are made without event mode and early return, so an FMU handles its
events inside its step, as FMI 3 then demands. One that requests event mode, returns early or
requests the end all the same is refused with that reason.
"""

from __future__ import annotations

import ctypes
import functools
import os
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ...errors import InstanceFailure
from ..description import Variable
from .buffers import DTYPES
from .in_process import InProcessInstance, listen, route
from .integrated import Integrated
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
        self._make_flags()
        return instantiate(
            *self._named_and_placed(folder),
            *(False, True, False, False),
            *(None, 0),
            listen(self),
            _logger(),
            None,
        )

    def _make_flags(self) -> None:
        """Where a step leaves its results."""
        self._event = ctypes.c_bool()
        self._terminate = ctypes.c_bool()
        self._early = ctypes.c_bool()
        self._reached = ctypes.c_double()
        results = (self._event, self._terminate, self._early, self._reached)
        self._flags = tuple(ctypes.addressof(entry) for entry in results)

    def _named_and_placed(self, folder: Path) -> tuple[bytes, bytes, bytes | None]:
        """Name, token and folder of the resources, as every instantiation begins."""
        resources = folder / "resources"
        place = (str(resources.resolve()) + os.sep).encode() if resources.is_dir() else None
        return self.name.encode(), self.interface.guid.encode(), place

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


class IntegratedFmi3Instance(Integrated, Fmi3Instance):
    """An instance of an FMI 3.0 FMU for model exchange."""

    RATES = "GetContinuousStateDerivatives"
    FLAG = FLAG

    def _instantiate(self, folder: Path) -> Any:
        from fmpy.fmi3 import fmi3LogMessageCallback

        instantiate = self._function(
            "fmi3InstantiateModelExchange",
            *(TEXT, TEXT, TEXT, FLAG, FLAG, POINTER, fmi3LogMessageCallback),
            result=POINTER,
        )
        made = ctypes.CFUNCTYPE(ctypes.c_int, POINTER, DOUBLE, DOUBLE, FLAG, *4 * [POINTER])
        self._do_step = made(lambda _, time, size, *__: self.stepped(time, size))
        self._make_flags()
        described = self._named_and_placed(folder)
        return instantiate(*described, False, True, listen(self), _logger())

    def _sizes(self) -> tuple[int, int]:
        counts = []
        for name in ("fmi3GetNumberOfContinuousStates", "fmi3GetNumberOfEventIndicators"):
            count = COUNT()
            self._call(self._function(name, POINTER, POINTER), ctypes.addressof(count))
            counts.append(count.value)
        return counts[0], counts[1]

    def _updated(self) -> tuple[bool, bool, float]:
        flags = [FLAG() for _ in range(5)]
        following = DOUBLE(inf)
        update = self._function("fmi3UpdateDiscreteStates", POINTER, *6 * [POINTER])
        self._call(update, *map(ctypes.addressof, flags), ctypes.addressof(following))
        again, ends, _, _, defined = (bool(flag.value) for flag in flags)
        return again, ends, following.value if defined else inf


@functools.cache
def _logger() -> Any:
    """The one callback of all instances, kept until the process ends."""
    from fmpy.fmi3 import fmi3LogMessageCallback

    return fmi3LogMessageCallback(_log)


def _log(environment: int | None, status: int, category: bytes, message: bytes | None) -> None:
    """Logger of all instances of FMI 3."""
    route(environment, status, message)
