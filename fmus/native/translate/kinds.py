"""The types of the subset: numbers, truth values, records, tuples of a fixed length, tables."""

from __future__ import annotations

import dataclasses
import types
import typing
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Scalar:
    """A number or a truth value; `c` is its type in C, `name` what it is called in a refusal."""

    c: str
    name: str


FLOAT = Scalar("double", "a float")
ROUNDED = Scalar("double", "a whole number of floor() or ceil()")
WHOLE = Scalar("int64_t", "an int")
TRUTH = Scalar("bool", "a bool")


@dataclass(frozen=True)
class Record:
    """A frozen dataclass: a struct of the same fields."""

    source: type[Any]

    @property
    def name(self) -> str:
        return f"a {self.source.__name__}"


@dataclass(frozen=True)
class Fixed:
    """A tuple of known length: a struct with an array if all entries are floats."""

    entries: tuple[Kind, ...]

    @property
    def name(self) -> str:
        return f"a tuple of {len(self.entries)}"

    @property
    def uniform(self) -> bool:
        return all(entry == FLOAT for entry in self.entries)


@dataclass(frozen=True)
class View:
    """A table that is handed on, of one or two dimensions and any size."""

    dimensions: int

    @property
    def name(self) -> str:
        return f"a table of {self.dimensions} dimensions"


@dataclass(frozen=True)
class Table:
    """A module's table, or a part of it, whose shape is known."""

    shape: tuple[int, ...]

    @property
    def name(self) -> str:
        return f"a table of {len(self.shape)} dimensions"


Kind = Scalar | Record | Fixed | View | Table

NUMBERS = (FLOAT, ROUNDED)
PLAIN: dict[Any, Kind] = {float: FLOAT, int: WHOLE, bool: TRUTH}


def kind_of(annotation: Any) -> Kind | None:
    """The type behind an annotation's value; none where the subset has no such type."""
    if annotation in (float, int, bool):
        return PLAIN[annotation]
    if isinstance(annotation, type) and dataclasses.is_dataclass(annotation):
        return Record(annotation)
    if not isinstance(annotation, types.GenericAlias) or typing.get_origin(annotation) is not tuple:
        return None
    entries = typing.get_args(annotation)
    if len(entries) == 2 and entries[1] is Ellipsis:
        row = kind_of(entries[0])
        if row == FLOAT:
            return View(1)
        return View(2) if row == View(1) else None
    inner = [kind_of(entry) for entry in entries]
    if not inner or any(entry is None or isinstance(entry, View) for entry in inner):
        return None
    return Fixed(tuple(entry for entry in inner if entry is not None))


def structured(kind: Kind) -> bool:
    """Whether it is a struct that functions take by its address."""
    return isinstance(kind, Record | Fixed)
