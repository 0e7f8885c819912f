"""An FMU in this process: what both versions of FMI have in common."""

from __future__ import annotations

import ctypes
import itertools
from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NoReturn
from weakref import WeakValueDictionary

import numpy as np

from ...errors import FmuError, InstanceFailure
from ..description import Interface, Variable
from .base import STATUS, Instance, Values
from .buffers import Block, blocks, is_too_wide, reader, too_wide, writer
from .library import loaded, shared_library
from .message_log import WARNING
from .place import (
    BEYOND,
    FORGET,
    RECEIVE,
    RECEIVE_FIRST,
    REFUSED,
    RESTORE,
    SAVE,
    SEND,
    Place,
    step_text,
)

FATAL = 4
PRESENT = 1e-6
"""Share of a step by which times of one communication point differ at most, by rounding."""
STATE_VERBS = {SAVE: "Get", RESTORE: "Set", FORGET: "Free"}

Calls = tuple[list[tuple[Block, int]], Values]


@dataclass(frozen=True)
class Binding:
    """An instance for a caller in C: addresses of functions, and the blocks to call them with.

    `place` is where its calls are noted, 0 where nobody watches.
    `flags` are the addresses of the results of an FMI 3 step, `states` those of get, set and free
    of FMU states; `faults` counts error messages. It stands at the time `now` [s].
    """

    component: Any
    do_step: int
    faults: ctypes.c_int32
    saved: int
    now: float
    place: int
    flags: tuple[int, ...]
    states: tuple[int, int, int]
    set: Calls
    get: list[Calls]


def address(function: Any) -> int:
    """Address of a function of a shared library."""
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)


class InProcessInstance(Instance):
    """An instance called through preallocated buffers.

    Subclasses define how their version of FMI names and shapes its functions; `dtypes` are the
    array types of the values that are passed.
    """

    PREFIX: ClassVar[str]
    dtypes: ClassVar[Mapping[str, Any]]
    place: Place | None = None

    def __init__(self, name: str, interface: Interface, folder: Path) -> None:
        super().__init__(name, interface)
        self.interpolates = interface.interpolates
        self._running = False
        self._instance: Any = None
        self._broken = False
        self._reason = ""
        self._saved: dict[int | None, float] = {}
        self._now = 0.0
        self._functions: dict[str, Any] = {}
        self._do_step: Any = None
        self._flags: tuple[int, ...] = ()
        self._library = loaded(interface, shared_library(interface, folder))
        self._instance = self._instantiate(folder)
        if not self._instance:
            raise InstanceFailure(f"{name}: cannot be instantiated{self.last_message()}")
        self._send: Callable[[], int] = _nothing
        self._receive: list[Callable[[], int]] = []
        self._sent: list[Block] = []
        self._given: Values = np.zeros(0)
        self._rising: list[int] = []
        self._outputs: list[Variable] = []
        self._rising_references: Any = None
        self._read: list[tuple[list[Block], Values]] = []
        self._start: dict[str, float | str] = {}

    def _function(self, name: str, *types: Any, result: Any = ctypes.c_int) -> Any:
        """A function of the library with its argument types."""
        if name in self._functions:
            return self._functions[name]
        try:
            function = self._library[name]
        except AttributeError:
            raise FmuError(
                f"{self.interface.path}: its library has no function {name}; build it again"
            ) from None
        function.argtypes = types
        function.restype = result
        self._functions[name] = function
        return function

    @abstractmethod
    def _instantiate(self, folder: Path) -> Any:
        """The instance, or null."""

    @abstractmethod
    def _bind(self, verb: str, kind: str, references: list[int], values: Any) -> Callable[[], int]:
        """Call without arguments that gets or sets variables of one type."""

    def _set_starts(self, start: Mapping[str, float | str]) -> None:
        """Set start values by name; other elements of an array keep what was set before."""
        self._start = {**self._start, **start}
        every = self.interface.variables.values()
        variables = [self.interface.variables[name] for name in start]
        numbers = [v for v in variables if v.numeric]
        for v in variables:
            if v.kind == "Binary" or (v.kind == "String" and v.extent > 1):
                raise InstanceFailure(
                    f"{self.name}: {v.name} is neither a number nor a text: it cannot be set"
                )
            if v.kind == "String":
                self._set_text(v, str(start[v.name]))
        for block in self._sent:
            block.preset(self.interface.of("input"), self._start)
        for block in blocks(numbers, self.dtypes):
            block.preset(every, self._start)
            entries = [v for v in numbers if v.kind == block.kind]
            block.take(np.array([float(start[v.name]) for v in entries]))
            call = self._bind("Set", block.kind, list(block.begin), block.staging)
            if status := call():
                self._fail(f"setting {', '.join(v.name for v in entries)}", status)

    @abstractmethod
    def _set_text(self, variable: Variable, text: str) -> None:
        """Set one String."""

    def set(self, start: dict[str, float | str]) -> None:
        self._set_starts(start)

    def connect(
        self,
        inputs: list[Variable],
        input_values: Values,
        outputs: list[list[Variable]],
        output_values: Values,
    ) -> None:
        self._sent, self._given = blocks(inputs, self.dtypes), input_values
        self._rising = [k for k, v in enumerate(inputs) if v.rises]
        self._rising_references = (ctypes.c_uint * len(self._rising))(
            *(inputs[k].reference for k in self._rising)
        )
        for block in self._sent:
            block.preset(self.interface.of("input"), self._start)
        self._send = writer(self._sent, input_values, lambda *what: self._bind("Set", *what))
        everything: list[Variable] = []
        self._receive, self._read = [], []
        for group in outputs:
            everything = everything + group
            made = blocks(everything, self.dtypes)
            values = output_values[: len(everything)]
            self._outputs = everything
            get = reader(self.name, made, values, lambda *what: self._bind("Get", *what))
            self._receive.append(get)
            self._read.append((made, values))

    def read_whole_at_once(self) -> None:
        self._receive, self._read = self._receive[-1:], self._read[-1:]

    def send(self) -> None:
        if status := self._send():
            self._fail("setting inputs", status)

    def receive(self, group: int = -1) -> None:
        status = self._receive[group]()
        if status or (self.faults and self._running):
            self._fail("reading outputs", status or 3)

    def texts(self, variables: list[Variable]) -> list[str]:
        return [self._text(variable) for variable in variables]

    def _text(self, variable: Variable) -> str:
        """The present text of a String, or of one element of an array of them."""
        pointers = np.zeros(variable.extent, dtype=np.uintp)
        status = self._bind("Get", "String", [variable.reference], pointers)()
        if status or (self.faults and self._running):
            self._fail(f"reading {variable.name}", status or 3)
        there = int(pointers[variable.element])
        return ctypes.string_at(there).decode("utf-8", "replace") if there else ""

    def step(self, time: float, size: float) -> None:
        self.steps += 1
        status = self._advance(time, size)
        self._now = time + size
        self.warned += status == WARNING
        if status:
            self._fail(step_text(time, size), status)

    @abstractmethod
    def _advance(self, time: float, size: float) -> int:
        """Status of one doStep, which may be rolled back only while an earlier state is saved."""

    def save(self) -> Any:
        state = ctypes.c_void_p()
        self._call(self._state_function("Get"), ctypes.addressof(state))
        self._saved[state.value] = self._now
        return state

    def restore(self, state: Any) -> None:
        self.rollbacks += 1
        self.faults = 0
        self._call(self._state_function("Set"), state)
        self._now = self._saved.get(state.value, self._now)

    def _returns(self, time: float, size: float) -> bool:
        """Whether a state is saved that is older than a step: one at its beginning is not prior."""
        return any(at < time - PRESENT * size for at in self._saved.values())

    def forget(self, state: Any) -> None:
        self._saved.pop(state.value, None)
        if not self._broken:
            self._call(self._state_function("Free"), ctypes.addressof(state))

    def binding(self) -> Binding:
        """What a caller in C needs: functions, blocks and buffers, all of them kept here."""
        return Binding(
            component=self._instance,
            do_step=address(self._do_step),
            faults=self._faults,
            saved=len(self._saved),
            now=self._now,
            place=ctypes.addressof(self.place) if self.place is not None else 0,
            flags=self._flags,
            states=self._state_addresses(),
            set=([(b, self._transfer("Set", b.kind)) for b in self._sent], self._given),
            get=[
                ([(b, self._transfer("Get", b.kind)) for b in made], values)
                for made, values in self._read
            ],
        )

    def explain(self, phase: int, status: int, time: float, size: float) -> NoReturn:
        """Raise the `InstanceFailure` of a call that was made in C, by its place in the loop."""
        if phase == BEYOND:
            kinds = [b.kind for made, _ in self._read for b in made if is_too_wide(b)]
            raise InstanceFailure(f"{self.name}: {too_wide(kinds[0])}")
        if phase == REFUSED:
            self._refuse(time, size)
        if phase == SEND:
            self._fail("setting inputs", status)
        if phase in (RECEIVE, RECEIVE_FIRST):
            self._fail("reading outputs", status)
        if phase in STATE_VERBS:
            self._fail(self._state_function(STATE_VERBS[phase]).__name__, status)
        self._fail(step_text(time, size), status)
        raise InstanceFailure(self._reason)

    def _state_addresses(self) -> tuple[int, int, int]:
        """Get, Set and Free of FMU states; zeros for an FMU that has none."""
        if not self.interface.rollback:
            return 0, 0, 0
        get, put, free = (address(self._state_function(v)) for v in ("Get", "Set", "Free"))
        return get, put, free

    def _transfer(self, verb: str, kind: str) -> int:
        """Address of the function that sets or gets one type."""
        return address(self._transfer_function(verb, kind))

    @abstractmethod
    def _transfer_function(self, verb: str, kind: str) -> Any:
        """The function that sets or gets variables of one type."""

    def _refuse(self, time: float, size: float) -> None:
        """`InstanceFailure` where a step that succeeded may not be taken."""

    @abstractmethod
    def _state_function(self, verb: str) -> Any:
        """Get, Set or Free of FMU states."""

    def close(self) -> None:
        """End the instance; safe to call twice, and after a failure.

        An instance that has reported a fatal error is left alone: FMI allows no call on it.
        """
        instance, self._instance = self._instance, None
        if instance is None or self._broken:
            return
        if self._running:
            self._function(f"{self.PREFIX}Terminate", ctypes.c_void_p)(instance)
        self._function(f"{self.PREFIX}FreeInstance", ctypes.c_void_p, result=None)(instance)

    def _call(self, function: Any, *arguments: Any) -> None:
        if self._broken:
            raise InstanceFailure(self._reason)
        if status := function(self._instance, *arguments):
            self._fail(function.__name__, status)

    def _fail(self, what: str, status: int) -> None:
        if status == WARNING:
            return
        self._broken = status >= FATAL
        label = STATUS[status] if 0 <= status < len(STATUS) else f"status {status}"
        self._reason = f"{self.name}: {what}: {label}{self.last_message()}"
        raise InstanceFailure(self._reason)


_listeners: WeakValueDictionary[int, Instance] = WeakValueDictionary()
_numbers = itertools.count(1)


def listen(instance: Instance) -> int:
    """Number that comes back with each message of an instance.

    fmpy's proxy for C varargs keeps one logger for the whole process, the last one given;
    only the environment that is given to each instance still distinguishes them.
    """
    number = next(_numbers)
    _listeners[number] = instance
    return number


def route(environment: int | None, status: int, message: bytes | None) -> None:
    """Pass a message to the instance that it comes from."""
    instance = _listeners.get(environment or 0)
    if instance is not None:
        instance.log(status, (message or b"").decode("utf-8", "replace"))


def _nothing() -> int:
    return 0
