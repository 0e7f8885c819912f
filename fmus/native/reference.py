"""The monolith's right-hand side, compiled: a reference solution at speed.

    derivative = right_hand_side(composition, amplifier.Input(), inside)
    solve_ivp(derivative, (t0, t1), y0, method="DOP853", rtol=1e-10)

It is the twin of `fmus.monolith.equations.rates`, bit by bit. Compiled once in a process, for all
compositions: parameters travel as one array.
"""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from ..amplifier.physics import Input
from ..monolith import equations
from ..monolith.equations import Composition, Vector
from . import mathematics
from .twin import Twins

Array = NDArray[np.float64]


def right_hand_side(
    composition: Composition, u: Input, inside: float
) -> Callable[[float, Array], Array]:
    """dy/dt over one smooth piece of the drive; the entries are `equations.FIELDS`.

    A trial state outside the model gives NaN, on which a solver shortens its step.
    """
    compiled = _compiled()
    constants = np.array([*_flat(composition), *_flat(u), inside])
    size = len(equations.FIELDS)

    def derivative(t: float, y: Array) -> Array:
        after = np.empty(size)
        try:
            compiled(constants, t, y, after)
        except (ValueError, OverflowError):
            after.fill(np.nan)
        return after

    return derivative


def _flat(record: Any) -> list[float]:
    """The floats of a record of floats and records, in order."""
    values: list[float] = []
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        values += [value] if isinstance(value, float) else _flat(value)
    return values


@functools.cache
def _compiled() -> Any:
    """`fill(constants, t, y, after)`: the records made of the array, the rates written out."""
    twins = Twins(__name__.split(".")[0])
    names: dict[str, Any] = {"rates": twins.module(equations).rates}
    places = iter(range(10_000))
    composition = _made(Composition, "constants", places, twins, names)
    drive = _made(Input, "constants", places, twins, names)
    inside = f"constants[{next(places)}]"
    state = _made(Vector, "y", iter(range(10_000)), twins, names)
    lines = [
        "def fill(constants, t, y, after):",
        f"    now = rates({composition}, {drive}, {inside}, t, {state})",
        *(f"    after[{k}] = now.{name}" for k, name in enumerate(equations.FIELDS)),
    ]
    exec("\n".join(lines), names)
    return numba.njit(**mathematics.OPTIONS)(names["fill"])


def _made(
    record: type[Any],
    array: str,
    places: typing.Iterator[int],
    twins: Twins,
    names: dict[str, Any],
) -> str:
    """Source of a call that makes a record's twin of the next places of an array."""
    kinds = typing.get_type_hints(record)
    name = f"record{len(names)}"
    names[name] = twins.record(record)
    given = []
    for field in dataclasses.fields(record):
        if kinds[field.name] is float:
            given.append(f"{array}[{next(places)}]")
        else:
            given.append(_made(kinds[field.name], array, places, twins, names))
    return f"{name}({', '.join(given)})"
