"""A physics module as numba sees it: the same code objects under other globals.

Frozen dataclasses of floats become named tuples of the same fields, nested tables of floats
read-only arrays, `math` and `int` their checked forms, functions of the package themselves
twins. Nothing is rewritten: a twin runs the byte code that the Python part runs.
"""

from __future__ import annotations

import dataclasses
import math
import sys
from collections import namedtuple
from types import FunctionType, ModuleType
from typing import Any

import numba
import numpy as np

from . import mathematics


class Twins:
    """The twins of a package's modules, made as they are asked for, and their `tables`."""

    def __init__(self, package: str) -> None:
        self._package = package
        self._math = mathematics.checked()
        self._modules: dict[str, ModuleType] = {}
        self._records: dict[type[Any], type[Any]] = {}
        self.tables: list[np.ndarray[Any, np.dtype[np.float64]]] = []

    def module(self, source: ModuleType) -> ModuleType:
        """The twin of a module, with all that its functions may look up."""
        name = source.__name__
        if name in self._modules:
            return self._modules[name]
        twin = self._modules[name] = ModuleType(f"twin of {name}")
        twin.__dict__["int"] = mathematics.integer
        for key, value in list(vars(source).items()):
            if not key.startswith("__"):
                twin.__dict__[key] = self._counterpart(value, source, twin)
        return twin

    def record(self, source: type[Any]) -> type[Any]:
        """The named tuple of a dataclass, one for each class wherever it is imported."""
        if source not in self._records:
            names = [field.name for field in dataclasses.fields(source)]
            self._records[source] = namedtuple(source.__name__, names)
        return self._records[source]

    def kind(self, source: type[Any]) -> Any:
        """numba's type of a record of floats."""
        record = self.record(source)
        return numba.typeof(record(*[0.0] * len(dataclasses.fields(source))))

    def _counterpart(self, value: Any, source: ModuleType, twin: ModuleType) -> Any:
        if value is math:
            return self._math
        if isinstance(value, ModuleType):
            return self.module(value) if self._own(value.__name__) else value
        if isinstance(value, FunctionType) and self._own(value.__module__):
            if value.__module__ != source.__name__:
                home = self.module(sys.modules[value.__module__])
                return getattr(home, value.__name__)
            same = FunctionType(value.__code__, vars(twin), value.__name__, value.__defaults__)
            same.__module__ = source.__name__
            return numba.njit(**mathematics.OPTIONS)(same)
        if isinstance(value, type) and dataclasses.is_dataclass(value):
            return self.record(value)
        table = _table(value)
        if table is not value:
            self.tables.append(table)
        return table

    def _own(self, module: str) -> bool:
        return module.split(".")[0] == self._package


def _table(value: Any) -> Any:
    """A nested table of floats as a read-only array; anything else as it is."""
    if not (isinstance(value, tuple) and value and isinstance(value[0], tuple)):
        return value
    try:
        table = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return value
    table.flags.writeable = False
    return table
