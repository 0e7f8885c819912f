"""One loaded FMU instance, called through preallocated buffers.

Legal order of calls, as in FMI 2.0: `prepare` (parameters), `enter_initialisation`, then any
number of `send` and `receive`, `exit_initialisation`, then `send`, `step`, `receive` in
rounds, at last `close`. After a `UnitFailure` a unit is broken: only `close` may follow.
"""

from __future__ import annotations

import atexit
import ctypes
import itertools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from .archive import platforms
from .errors import FmuError, UnitFailure, printable
from .interface import Interface, Variable

STATUS = ("OK", "warning", "discard", "error", "fatal", "pending")
FATAL = 4
FAULTY = (3, 4)
MOST_MESSAGES = 200


class Unit:
    """An instance of an FMU inside this process.

    `inputs` and `outputs` are views on the system's buffers, in the order of the variables
    given to :meth:`connect`. Time is the caller's: a unit only passes it on.
    """

    def __init__(self, name: str, interface: Interface, folder: Path) -> None:
        from fmpy import fmi2

        self.name = name
        self.interface = interface
        self.messages: list[str] = []
        self.steps = 0
        self.faults = 0
        self._running = False
        self._instance: Any = None
        self._broken = False
        self._api = fmi2
        self._fmu = self._load(folder)
        self._logger = fmi2.fmi2CallbackLoggerTYPE(_route)
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = self._logger
        self._callbacks.componentEnvironment = _listen(self)
        self._callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        self._proxy_logger()
        resources = _location(folder / "resources", interface.tool)
        self._instance = self._fmu.fmi2Instantiate(
            name.encode(),
            fmi2.fmi2CoSimulation,
            interface.guid.encode(),
            resources.encode(),
            ctypes.byref(self._callbacks),
            fmi2.fmi2False,
            fmi2.fmi2True,
        )
        if not self._instance:
            raise UnitFailure(f"{name}: cannot be instantiated{self._said()}")
        self._do_step = self._raw("fmi2DoStep")
        self._send: Callable[[], int] = _nothing
        self._receive: list[Callable[[], int]] = []

    def _load(self, folder: Path) -> Any:
        """The shared library of this platform, through fmpy."""
        identifier = self.interface.identifier
        library = folder / "binaries" / _platform() / f"{identifier}{_suffix()}"
        if not library.is_file():
            found = ", ".join(platforms(self.interface.path)) or "none"
            raise FmuError(
                f"{self.interface.path}: no binary for {_platform()} (there is: {found});"
                " rebuild the FMU for this platform"
            )
        cwd = Path.cwd()
        try:
            loaded = self._api.FMU2Slave(
                guid=self.interface.guid,
                unzipDirectory=str(folder),
                modelIdentifier=identifier,
                instanceName=self.name,
            )
            _end_in_order(loaded.dll)
            return loaded
        except Exception as error:
            message = printable(str(error), most=400)
            raise FmuError(f"{self.interface.path}: cannot be loaded: {message}") from None
        finally:
            os.chdir(cwd)

    def _proxy_logger(self) -> None:
        """Let fmpy's proxy format the C varargs of log messages, where it is there."""
        try:
            from fmpy.logging import addLoggerProxy
        except Exception:
            return
        addLoggerProxy(ctypes.byref(self._callbacks))

    def _raw(self, function: str) -> Any:
        return self._fmu._functions[function]

    def prepare(
        self, start: dict[str, float | str], time: float, stop: float, tolerance: float | None
    ) -> None:
        """Set parameters and start values by name, and announce the experiment."""
        self._call(
            self._raw("fmi2SetupExperiment"),
            int(tolerance is not None),
            tolerance or 0.0,
            time,
            1,
            stop,
        )
        for name, value in start.items():
            self._set_one(self.interface.variables[name], value)

    def _set_one(self, variable: Variable, value: float | str) -> None:
        reference = (ctypes.c_uint * 1)(variable.reference)
        kinds: dict[str, tuple[str, Any]] = {
            "Real": ("fmi2SetReal", ctypes.c_double),
            "Integer": ("fmi2SetInteger", ctypes.c_int),
            "Enumeration": ("fmi2SetInteger", ctypes.c_int),
            "Boolean": ("fmi2SetBoolean", ctypes.c_int),
            "String": ("fmi2SetString", ctypes.c_char_p),
        }
        function, kind = kinds[variable.kind]
        if kind is ctypes.c_char_p:
            converted: Any = str(value).encode()
        elif kind is ctypes.c_double:
            converted = float(value)
        else:
            converted = int(float(value))
        self._call(self._raw(function), reference, 1, (kind * 1)(converted))

    def connect(
        self,
        inputs: list[Variable],
        input_values: NDArray[np.float64],
        outputs: list[list[Variable]],
        output_values: NDArray[np.float64],
    ) -> None:
        """Bind buffers: `send` passes all inputs, `receive(k)` the outputs of group 0 to k."""
        self._send = self._bound("fmi2SetReal", inputs, input_values)
        everything: list[Variable] = []
        self._receive = []
        for group in outputs:
            everything = everything + group
            self._receive.append(self._bound("fmi2GetReal", everything, output_values))

    def _bound(
        self, function: str, variables: list[Variable], values: NDArray[np.float64]
    ) -> Callable[[], int]:
        """A call without arguments that moves `variables` from or to `values`."""
        count = len(variables)
        if not count:
            return _nothing
        raw = self._raw(function)
        instance = self._instance
        references = (ctypes.c_uint * count)(*(v.reference for v in variables))
        pointer = values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        keep = (references, values)

        def call() -> int:
            return int(raw(instance, keep[0], count, pointer))

        return call

    def read_whole_at_once(self) -> None:
        """Let every `receive` read all outputs: for units that no later pass reads again."""
        self._receive = self._receive[-1:]

    def enter_initialisation(self) -> None:
        self._call(self._raw("fmi2EnterInitializationMode"))

    def exit_initialisation(self) -> None:
        self._call(self._raw("fmi2ExitInitializationMode"))
        self.faults = 0
        self._running = True

    def send(self) -> None:
        """Pass the input buffer to the unit."""
        if self._send():
            self._fail("setting inputs")

    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]; `UnitFailure` unless the unit says OK."""
        self.steps += 1
        status = self._do_step(self._instance, time, size, 1)
        if status:
            self._fail(f"step from t = {time:.9g} s by {size:.4g} s", status)

    def receive(self, group: int = -1) -> None:
        """Fill the output buffer, up to a group; all by default."""
        if self._receive[group]() or (self.faults and self._running):
            self._fail("reading outputs")

    def save(self) -> Any:
        """FMU state as it is now, to be given to :meth:`restore` and :meth:`forget`."""
        state = self._api.fmi2FMUstate()
        self._call(self._raw("fmi2GetFMUstate"), ctypes.byref(state))
        return state

    def restore(self, state: Any) -> None:
        self._call(self._raw("fmi2SetFMUstate"), state)

    def forget(self, state: Any) -> None:
        self._call(self._raw("fmi2FreeFMUstate"), ctypes.byref(state))

    def close(self) -> None:
        """End the instance; safe to call twice, and after a failure.

        An instance that has reported a fatal error is left alone: FMI allows no call on it.
        """
        if self._instance is not None and not self._broken:
            self._raw("fmi2Terminate")(self._instance)
            self._raw("fmi2FreeInstance")(self._instance)
        self._instance = None

    def _call(self, function: Any, *arguments: Any) -> None:
        status = function(self._instance, *arguments)
        if status:
            self._fail(function.__name__, status)

    def _fail(self, what: str, status: int = 3) -> None:
        if status == 1:
            return
        self._broken = status >= FATAL
        label = STATUS[status] if status < len(STATUS) else f"status {status}"
        raise UnitFailure(f"{self.name}: {what}: {label}{self._said()}")

    def _said(self) -> str:
        """The last message of the unit, to go behind an error."""
        return f": {self.messages[-1]}" if self.messages else ""

    def log(self, status: int, message: bytes) -> None:
        """Keep a message of the unit, made safe to print; the first of many only.

        A message with an error counts as a fault even where the call itself says OK: a
        getter of an exported Python part has no other way to say that there is no answer.
        """
        self.faults += status in FAULTY
        if len(self.messages) < MOST_MESSAGES and message:
            text = printable(message.decode("utf-8", "replace"), most=500)
            self.messages.append(text.removeprefix(f"{self.name}: "))


_listeners: WeakValueDictionary[int, Unit] = WeakValueDictionary()
_numbers = itertools.count(1)


def _listen(unit: Unit) -> int:
    """Number under which a unit's messages come back.

    fmpy's proxy for C varargs keeps one logger for the whole process, the last one given;
    the component environment is what still tells the units apart.
    """
    number = next(_numbers)
    _listeners[number] = unit
    return number


def _route(
    environment: int | None, instance: bytes, status: int, category: bytes, message: bytes
) -> None:
    """Logger of all units: hand the message to the one that it comes from."""
    unit = _listeners.get(environment or 0)
    if unit is not None:
        unit.log(status, message)


_ending: set[int] = set()


def _end_in_order(library: Any) -> None:
    """Have PythonFMU's interpreter state freed while the process is still whole.

    Its library frees that state twice when the process takes it down, which corrupts the
    heap and may abort a process that has done its work; freed before, it is null by then.
    """
    finish = getattr(library, "finalizePythonInterpreter", None)
    if finish is not None and library._handle not in _ending:
        _ending.add(library._handle)
        atexit.register(finish)


def _location(folder: Path, tool: str) -> str:
    """URI of the resources; plain for PythonFMU, which takes the text behind `file://` as it is."""
    whole = folder.resolve()
    if "PythonFMU" not in tool:
        return whole.as_uri()
    path = whole.as_posix()
    return f"file://{path}" if path.startswith("/") else f"file:///{path}"


def _nothing() -> int:
    return 0


def _platform() -> str:
    from fmpy import platform

    return str(platform)


def _suffix() -> str:
    from fmpy import sharedLibraryExtension

    return str(sharedLibraryExtension)
