"""`math` and `int` for compiled physics, with the errors that CPython raises.

A C library answers sqrt(-1) with NaN and exp(1000) with infinity; CPython raises, and
a part's failed step rests on that. The rule is CPython's own: NaN out of a number is a domain
error, infinity out of a finite number is a range error where the function can overflow, else
a domain error. `floor` and `ceil` give floats here and never -0.0, as a Python int turned
into a float; `int` saturates beyond 64 bits, where Python goes on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numba

OPTIONS: dict[str, Any] = {"error_model": "python", "boundscheck": True, "_nrt": False}
"""How everything is compiled: divisions and table look-ups checked, no reference counts."""

DOMAIN = "math domain error"
RANGE = "math range error"
ROUNDED = "cannot convert float infinity to integer"
NOT_A_NUMBER = "cannot convert float NaN to integer"
LARGEST = 2**63 - 1
BEYOND = 2.0**63
WHOLE = 2.0**52
"""From here on every float is a whole number."""

PLAIN = ("atan", "atan2", "copysign", "fabs", "tanh", "asinh")
"""Functions without errors on real numbers."""

BOUNDED = ("sqrt", "sin", "cos", "tan", "asin", "acos", "log", "log1p", "log10", "log2")
"""Functions that cannot overflow: infinity out of a number is a pole."""

GROWING = ("sinh", "cosh", "exp", "expm1")
"""Functions that can overflow."""


def _bounded(raw: Callable[[float], float]) -> Any:
    def checked(x: float) -> float:
        y = raw(x)
        if math.isnan(y) and not math.isnan(x):
            raise ValueError(DOMAIN)
        if math.isinf(y) and not math.isinf(x):
            raise ValueError(DOMAIN)
        return y

    return numba.njit(**OPTIONS)(checked)


def _growing(raw: Callable[[float], float]) -> Any:
    def checked(x: float) -> float:
        y = raw(x)
        if math.isinf(y) and not math.isinf(x):
            raise OverflowError(RANGE)
        return y

    return numba.njit(**OPTIONS)(checked)


@numba.njit(**OPTIONS)  # type: ignore[untyped-decorator]
def power(x: float, y: float) -> float:
    """x^y; a pole at zero is a domain error."""
    z = math.pow(x, y)
    if math.isfinite(x) and math.isfinite(y):
        if math.isnan(z):
            raise ValueError(DOMAIN)
        if math.isinf(z):
            if x == 0.0:
                raise ValueError(DOMAIN)
            raise OverflowError(RANGE)
    return z


@numba.njit(**OPTIONS)  # type: ignore[untyped-decorator]
def floor(x: float) -> float:
    """Largest whole number up to x."""
    if math.isinf(x):
        raise OverflowError(ROUNDED)
    if math.isnan(x):
        raise ValueError(NOT_A_NUMBER)
    if math.fabs(x) >= WHOLE:
        return x
    return float(math.floor(x))


@numba.njit(**OPTIONS)  # type: ignore[untyped-decorator]
def ceil(x: float) -> float:
    """Least whole number from x on."""
    if math.isinf(x):
        raise OverflowError(ROUNDED)
    if math.isnan(x):
        raise ValueError(NOT_A_NUMBER)
    if math.fabs(x) >= WHOLE:
        return x
    return float(math.ceil(x))


@numba.njit(**OPTIONS)  # type: ignore[untyped-decorator]
def integer(x: float) -> int:
    """Towards zero."""
    if math.isinf(x):
        raise OverflowError(ROUNDED)
    if math.isnan(x):
        raise ValueError(NOT_A_NUMBER)
    if x >= BEYOND:
        return LARGEST
    if x <= -BEYOND:
        return -LARGEST
    return int(x)


def checked() -> ModuleType:
    """A module with the part of `math` that physics may use."""
    module = ModuleType("mathematics")
    module.pi = math.pi  # type: ignore[attr-defined]
    for name in PLAIN:
        setattr(module, name, getattr(math, name))
    for name in BOUNDED:
        setattr(module, name, _bounded(getattr(math, name)))
    for name in GROWING:
        setattr(module, name, _growing(getattr(math, name)))
    for name, function in (("pow", power), ("floor", floor), ("ceil", ceil)):
        setattr(module, name, function)
    return module
