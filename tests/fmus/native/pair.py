"""The Python slave of a part and its native library, called alike and held against each other."""

from __future__ import annotations

import ctypes
import importlib
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import fmi2
from numpy.typing import NDArray

from fmus.quantity import NO_REFERENCE
from fmus.slave import PhysicsSlave
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance.library import shared_library

Row = NDArray[np.float64]
OK, DISCARD, ERROR = 0, 2, 3
COUNT = ctypes.c_size_t
DOUBLE = ctypes.c_double
POINTER = ctypes.c_void_p

SIZES = {
    "N": 0.05, "N/m": 300.0, "N.s/m": 0.2, "N/s": 5.0, "N/s2": 500.0, "m": 5e-4, "m/s": 0.05,
    "rad": 0.1, "rad/s": 30.0, "V": 1500.0, "V/s": 2e5, "V2/s2": 1e13, "N.m": 1e-5, "N.m.s": 1e-6,
    "N.m.s2": 1e-9, "N.m.s3": 1e-11, "kg.m2": 1e-8, "kg.m2.s": 1e-11, "C": 5e-6, "F": 3e-9,
    "A": 1e-4, "A/s": 1e-2, "F/s": 1e-9, "F/V2": 1e-18,
}  # fmt: skip
"""Size of an input by its unit; 1 where a unit is not listed."""


def same(one: Row, other: Row) -> bool:
    """Bitwise equal, any NaN counting as NaN."""
    nan = np.isnan(one) & np.isnan(other)
    return bool(np.all(nan | (one.view(np.int64) == other.view(np.int64))))


def slave_class(part: str) -> type[PhysicsSlave]:
    """The slave of a part, by the folder it is in."""
    module = importlib.import_module(f"fmus.{part}.slave")
    found = [v for v in vars(module).values() if getattr(v, "part", None) is module.PART]
    slave: type[PhysicsSlave] = found[0]
    return slave


class Library:
    """The FMI functions of a native FMU's library."""

    def __init__(self, fmu: Path, folder: Path) -> None:
        extract(fmu, folder)
        self.interface = read_interface(fmu)
        self._library = ctypes.CDLL(str(shared_library(self.interface, folder)))
        self.messages: list[tuple[int, str, str]] = []
        self.callbacks = fmi2.fmi2CallbackFunctions()
        self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._heard)

    def _heard(self, _: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append((status, category.decode(), message.decode()))

    def instantiate(
        self, name: str, guid: str | None = None, kind: int = 1, logging: int = 1
    ) -> int | None:
        """Address of a new instance, or none."""
        make = self._library.fmi2Instantiate
        make.restype = POINTER
        text = ctypes.c_char_p
        make.argtypes = [text, ctypes.c_int, text, text, POINTER, ctypes.c_int, ctypes.c_int]
        token = self.interface.guid if guid is None else guid
        where = ctypes.addressof(self.callbacks)
        made: int | None = make(name.encode(), kind, token.encode(), b"", where, 0, logging)
        return made

    def call(self, unit: int, name: str, *arguments: Any) -> int:
        """Status of one function of FMI."""
        status: int = getattr(self._library, f"fmi2{name}")(POINTER(unit), *arguments)
        return status

    def free(self, unit: int) -> None:
        self._library.fmi2FreeInstance.restype = None
        self._library.fmi2FreeInstance(POINTER(unit))


class Pair:
    """Both kinds of one part; every call goes to both, and every answer is compared."""

    def __init__(self, part: str, library: Library) -> None:
        self.part = part
        self.library = library
        self.slave = slave_class(part)(instance_name="unit")
        unit = library.instantiate("unit")
        assert unit is not None
        self.unit = unit
        library.messages.clear()
        self.variables = self.slave.part.variables
        self.inputs = [k for k, v in enumerate(self.variables) if v.causality == "input"]
        self.parameters = [k for k, v in enumerate(self.variables) if v.causality == "parameter"]
        self.outputs = [k for k, v in enumerate(self.variables) if v.causality == "output"]
        self.discarded = 0

    def close(self) -> None:
        self.library.free(self.unit)

    def agree(self) -> None:
        """Both have said the same since the last time."""
        own = [(m.status.value, m.category, m.msg) for m in self.slave.log_queue]
        assert own == self.library.messages
        self.slave.log_queue.clear()
        self.library.messages.clear()

    def set(self, references: list[int], values: Row) -> None:
        self.slave.set_real(references, values.tolist())
        status = self.library.call(self.unit, "SetReal", *_sent(references, values))
        assert status == OK
        self.agree()

    def get(self, references: list[int]) -> Row:
        own = np.array(self.slave.get_real(references))
        values = np.empty(len(references))
        assert self.library.call(self.unit, "GetReal", *_sent(references, values)) == OK
        self.agree()
        names = [self.variables[k].name for k in references]
        differing = [
            (n, a, b)
            for n, a, b in zip(names, own, values, strict=True)
            if not same(np.array([a]), np.array([b]))
        ]
        assert not differing
        return own

    def initialise(self, time: float) -> bool:
        """Whether both could be initialised; none but both can."""
        self.slave.setup_experiment(time, None, None)
        for name, arguments in (
            ("SetupExperiment", (0, DOUBLE(0.0), DOUBLE(time), 0, DOUBLE(0.0))),
            ("EnterInitializationMode", ()),
        ):
            assert self.library.call(self.unit, name, *arguments) == OK
        status = self.library.call(self.unit, "ExitInitializationMode")
        try:
            self.slave.exit_initialization_mode()
            well = True
        except Exception:
            well = False
        assert status == (OK if well else ERROR)
        self.agree()
        return well

    def step(self, time: float, size: float) -> bool:
        well = self.slave.do_step(time, size)
        status = self.library.call(self.unit, "DoStep", DOUBLE(time), DOUBLE(size), 1)
        assert status == (OK if well else DISCARD)
        self.agree()
        self.discarded += not well
        reached = DOUBLE()
        assert self.library.call(self.unit, "GetRealStatus", 2, ctypes.byref(reached)) == OK
        assert reached.value == (time + size if well else time)
        return well

    def reset(self) -> None:
        self.slave = slave_class(self.part)(instance_name="unit")
        assert self.library.call(self.unit, "Reset") == OK

    def save(self) -> tuple[Any, Any]:
        state = POINTER()
        assert self.library.call(self.unit, "GetFMUstate", ctypes.byref(state)) == OK
        return self.slave._get_fmu_state(), state

    def through_bytes(self, saved: tuple[Any, Any]) -> tuple[Any, Any]:
        """A saved state written to bytes and read back."""
        own, state = saved
        size = COUNT()
        call = self.library.call
        assert call(self.unit, "SerializedFMUstateSize", state, ctypes.byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert call(self.unit, "SerializeFMUstate", state, buffer, size) == OK
        assert call(self.unit, "FreeFMUstate", ctypes.byref(state)) == OK
        other = POINTER()
        assert call(self.unit, "DeSerializeFMUstate", buffer, size, ctypes.byref(other)) == OK
        kind = type(self.slave)
        return kind._fmu_state_from_bytes(kind._fmu_state_to_bytes(own)), other

    def restore(self, saved: tuple[Any, Any]) -> None:
        own, state = saved
        self.slave._set_fmu_state(own)
        assert self.library.call(self.unit, "SetFMUstate", state) == OK

    def forget(self, saved: tuple[Any, Any]) -> None:
        assert self.library.call(self.unit, "FreeFMUstate", ctypes.byref(saved[1])) == OK

    def drive(self, rng: np.random.Generator, time: float, step: float) -> Row:
        """Inputs of plausible size, some of them beyond what a step can bear."""
        row = np.empty(len(self.inputs))
        for place, k in enumerate(self.inputs):
            v = self.variables[k]
            unit = v.quantity.unit
            if unit == "s":
                row[place] = rng.choice([NO_REFERENCE, time, time - step * rng.random()])
            elif v.start > 0.0 and v.quantity.order == 0:
                row[place] = v.start * rng.uniform(0.5, 1.5)
            else:
                size = SIZES.get(unit, 1.0)
                row[place] = size * rng.uniform(-1.0, 1.0) * rng.choice([1.0, 1.0, 0.0, 1.3])
        if len(row) and rng.random() < 0.003:
            row[rng.integers(len(row))] = rng.choice([np.nan, np.inf, -np.inf, 1e9, -1e9])
        return row

    def tune(self, rng: np.random.Generator, everything: bool) -> tuple[list[int], Row]:
        """New values for some parameters, now and then one that is out of its bounds."""
        chosen = [
            k
            for k in self.parameters
            if (everything or self.variables[k].quantity.tunable) and rng.random() < 0.4
        ]
        values = np.empty(len(chosen))
        for place, k in enumerate(chosen):
            v = self.variables[k]
            if v.quantity.choices:
                values[place] = rng.integers(len(v.quantity.choices)) + 1
            else:
                size = v.start if v.start else SIZES.get(v.quantity.unit, 1.0)
                values[place] = size * rng.choice([0.5, 0.9, 1.0, 1.1, 2.0])
            if rng.random() < 0.02:
                values[place] = rng.choice([np.nan, -np.inf, np.inf, -1e40, -1e-3])
        return chosen, values


def _sent(references: list[int], values: Row) -> tuple[Any, Any, Any]:
    wanted = (ctypes.c_uint * len(references))(*references)
    return wanted, COUNT(len(references)), values.ctypes.data_as(POINTER)
