"""FMI 2.0, for co-simulation and for model exchange."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ..description import Variable
from .base import Values
from .in_process import InProcessInstance, listen, route
from .integrated import Integrated

MODEL_EXCHANGE, CO_SIMULATION = 0, 1
POINTER = ctypes.c_void_p
DOUBLE = ctypes.c_double
COUNT = ctypes.c_size_t
FLAG = ctypes.c_int


class Fmi2Instance(InProcessInstance):
    """An instance of an FMI 2.0 FMU."""

    PREFIX = "fmi2"
    dtypes: ClassVar = {
        "Real": np.float64,
        "Integer": np.int32,
        "Boolean": np.int32,
        "Enumeration": np.int32,
    }
    SUFFIX: ClassVar = {"Enumeration": "Integer"}
    KIND = CO_SIMULATION

    def _instantiate(self, folder: Path) -> Any:
        from fmpy import fmi2

        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = _logger()
        self._callbacks.componentEnvironment = listen(self)
        self._callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        _format_varargs(self._callbacks)
        text = ctypes.c_char_p
        instantiate = self._function(
            "fmi2Instantiate", text, FLAG, text, text, POINTER, FLAG, FLAG, result=POINTER
        )
        self._do_step = self._stepper()
        return instantiate(
            self.name.encode(),
            self.KIND,
            self.interface.guid.encode(),
            _location(folder / "resources", self.interface.tool).encode(),
            ctypes.addressof(self._callbacks),
            0,
            1,
        )

    def rates(self) -> Values | None:
        count = len(self._outputs)
        if not self.interface.rates or not all(v.rises for v in self._outputs):
            return None
        types = (POINTER, POINTER, COUNT, POINTER, POINTER)
        function = self._function("fmi2GetRealOutputDerivatives", *types)
        references = (ctypes.c_uint * count)(*(v.reference for v in self._outputs))
        orders = (ctypes.c_int * count)(*count * [1])
        values = np.empty(count)
        there = (ctypes.addressof(references), count)
        self._call(function, *there, ctypes.addressof(orders), values.ctypes.data)
        return values

    def incline(self, rates: Values) -> None:
        count = len(self._rising)
        types = (POINTER, POINTER, COUNT, POINTER, POINTER)
        function = self._function("fmi2SetRealInputDerivatives", *types)
        orders = (ctypes.c_int * count)(*count * [1])
        values = (DOUBLE * count)(*rates[self._rising])
        there = (ctypes.addressof(self._rising_references), count)
        self._call(function, *there, ctypes.addressof(orders), ctypes.addressof(values))

    def _stepper(self) -> Any:
        """What makes a step, for Python and for C."""
        return self._function("fmi2DoStep", POINTER, DOUBLE, DOUBLE, FLAG)

    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        setup = self._function("fmi2SetupExperiment", POINTER, FLAG, DOUBLE, DOUBLE, FLAG, DOUBLE)
        accuracy = (int(tolerance is not None), tolerance or 0.0)
        self._call(setup, *accuracy, time, int(stop is not None), stop or 0.0)
        self._now = time
        self._set_starts(start)

    def _transfer_function(self, verb: str, kind: str) -> Any:
        name = f"fmi2{verb}{self.SUFFIX.get(kind, kind)}"
        return self._function(name, POINTER, POINTER, COUNT, POINTER)

    def _bind(self, verb: str, kind: str, references: list[int], values: Any) -> Callable[[], int]:
        count = len(references)
        raw = self._transfer_function(verb, kind)
        wanted = (ctypes.c_uint * count)(*references)
        instance = self._instance
        there = ctypes.addressof(wanted)
        pointer = values.ctypes.data
        keep = (wanted, values)

        def call() -> int:
            status: int = raw(instance, there, count, pointer)
            return status if keep else 0

        return call

    def _set_text(self, variable: Variable, text: str) -> None:
        set_string = self._function("fmi2SetString", POINTER, POINTER, COUNT, POINTER)
        reference = (ctypes.c_uint * 1)(variable.reference)
        values = (ctypes.c_char_p * 1)(text.encode())
        self._call(set_string, ctypes.addressof(reference), 1, ctypes.addressof(values))

    def enter_initialisation(self) -> None:
        self._call(self._function("fmi2EnterInitializationMode", POINTER))

    def exit_initialisation(self) -> None:
        self._call(self._function("fmi2ExitInitializationMode", POINTER))
        self.faults = 0
        self._running = True

    def _advance(self, time: float, size: float) -> int:
        final = not self._returns(time, size)
        status: int = self._do_step(self._instance, time, size, final)
        return status

    def _state_function(self, verb: str) -> Any:
        return self._function(f"fmi2{verb}FMUstate", POINTER, POINTER)


class IntegratedFmi2Instance(Integrated, Fmi2Instance):
    """An instance of an FMI 2.0 FMU for model exchange."""

    KIND = MODEL_EXCHANGE
    RATES = "GetDerivatives"
    FLAG = FLAG

    def _stepper(self) -> Any:
        from fmpy.fmi2 import fmi2EventInfo

        self._event = fmi2EventInfo()
        made = ctypes.CFUNCTYPE(ctypes.c_int, POINTER, DOUBLE, DOUBLE, FLAG)
        return made(lambda _, time, size, __: self.stepped(time, size))

    def _sizes(self) -> tuple[int, int]:
        return self.interface.states, self.interface.indicators

    def _updated(self) -> tuple[bool, bool, float]:
        event = self._event
        update = self._function("fmi2NewDiscreteStates", POINTER, POINTER)
        self._call(update, ctypes.addressof(event))
        following = event.nextEventTime if event.nextEventTimeDefined else inf
        return bool(event.newDiscreteStatesNeeded), bool(event.terminateSimulation), following


@functools.cache
def _logger() -> Any:
    """The one callback of all instances; fmpy's proxy keeps it until the process ends."""
    from fmpy import fmi2

    return fmi2.fmi2CallbackLoggerTYPE(_log)


def _log(
    environment: int | None, instance: bytes, status: int, category: bytes, message: bytes | None
) -> None:
    """Logger of all instances of FMI 2."""
    route(environment, status, message)


def _format_varargs(callbacks: Any) -> None:
    """Let fmpy's proxy format the C varargs of log messages, where fmpy has one."""
    try:
        from fmpy.logging import addLoggerProxy
    except Exception:
        return
    addLoggerProxy(ctypes.byref(callbacks))


def _location(folder: Path, tool: str) -> str:
    """URI of the resources; plain for PythonFMU, which takes the text behind `file://` as it is."""
    whole = folder.resolve()
    if "PythonFMU" not in tool:
        return whole.as_uri()
    path = whole.as_posix()
    return f"file://{path}" if path.startswith("/") else f"file:///{path}"
