"""Conversion of units: texts such as `1.9 mm` to SI, by pint.

Inside the program, numbers are plain floats in SI. FMI writes products as `N.s/m` and `V2/s2`.
"""

from __future__ import annotations

import functools
import math
import re
from typing import Any

from .errors import printable

_SYMBOL = r"[A-Za-zµμΩ%°]+(?:(?:\*\*|\^)?-?[0-9])?"
_FACTOR = rf"\(?(?:1|{_SYMBOL})\)?"
_UNIT = re.compile(rf"{_FACTOR}(?:\s*[*/.·]\s*{_FACTOR})*")
"""Products of symbols with one-digit exponents; nothing that a parser would have to compute."""

OFFSET_UNITS = ("degC", "degF", "celsius", "fahrenheit")


class UnitError(ValueError):
    """A text that is not a quantity, or not convertible to the unit asked for."""


@functools.cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


@functools.cache
def parsed(unit: str) -> Any:
    """FMI unit string as a pint unit; `UnitError` where pint does not know it."""
    if unit not in {"", "-"} and not (len(unit) <= 60 and _UNIT.fullmatch(unit)):
        raise UnitError(f"{printable(unit, most=60)!r} is not a product of units")
    text = re.sub(r"([A-Za-z])(\d)", r"\1**\2", unit).replace(".", "*").replace("Ohm", "ohm")
    try:
        return _registry().Unit("dimensionless" if text in {"1", "", "-"} else text)
    except Exception as error:
        raise UnitError(f"unknown unit {unit!r} ({printable(str(error))})") from None


def factor(from_unit: str, to_unit: str) -> float:
    """Factor that converts a number from one unit to the other.

    Raises `UnitError` where the dimensions differ, or where a conversion would need an
    offset (degrees Celsius): such a wire is ambiguous between value and difference.
    """
    if from_unit == to_unit:
        return 1.0
    one, other = parsed(from_unit), parsed(to_unit)
    registry = _registry()
    if one.dimensionality != other.dimensionality:
        raise UnitError(f"{from_unit or '1'} is not convertible to {to_unit or '1'}")
    zero = registry.Quantity(0.0, one).to(other).magnitude
    if zero != 0.0:
        raise UnitError(f"{from_unit} to {to_unit} needs an offset: state gain and offset")
    return float(registry.Quantity(1.0, one).to(other).magnitude)


_NAMED = ("1", "m", "s", "kg", "A", "K", "rad", "Hz", "N", "Pa", "J", "W", "C", "V", "Ohm", "F")
_BASES = {
    "kilogram": "kg", "meter": "m", "second": "s", "ampere": "A", "kelvin": "K", "mole": "mol",
    "candela": "cd", "radian": "rad",
}  # fmt: skip


def in_base(unit: str) -> tuple[str, float]:
    """The SI unit of the same dimension as FMI writes it, and how many of it one `unit` is.

    `V` and `m/s` stay what they are, `mN` becomes `N`, `g*mm` `kg.m`. Raises `UnitError` for
    what is not a unit, and for degrees Celsius and Fahrenheit.
    """
    one = parsed(unit)
    registry = _registry()
    if registry.Quantity(0.0, one).to_base_units().magnitude != 0.0:
        raise UnitError(f"{unit} needs an offset: give kelvin")
    base = registry.Quantity(1.0, one).to_base_units()
    for name in _NAMED:
        named = parsed(name)
        angle = "radian" in str(base.units)
        if named.dimensionality == one.dimensionality and angle == (name == "rad"):
            return name, float(registry.Quantity(1.0, one).to(named).magnitude)
    powers = dict(base.unit_items())
    over, under = (
        [
            f"{_BASES[n]}{'' if abs(p) == 1 else int(abs(p))}"
            for n, p in powers.items()
            if sign * p > 0
        ]
        for sign in (1, -1)
    )
    return "/".join([".".join(over) or "1", *under]), float(base.magnitude)


def si_value(text: str | float, unit: str) -> float:
    """A number, or a text with a unit, as a finite number in `unit` (an SI unit).

    A text without a unit counts as being in `unit` already.
    """
    if isinstance(text, bool):
        raise UnitError("true and false are not numbers")
    if isinstance(text, int | float):
        return _finite(float(text), str(text))
    words = text.strip()
    try:
        return _finite(float(words), words)
    except UnitError:
        raise
    except ValueError:
        pass
    match = re.fullmatch(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.+)", words)
    if not match:
        raise UnitError(f"{printable(text, most=60)!r} is not a number with a unit")
    number = _finite(float(match[1]), words)
    symbol = match[2]
    if symbol in OFFSET_UNITS:
        raise UnitError(f"{symbol} is ambiguous: give kelvin")
    try:
        scale = factor(symbol, unit)
    except UnitError:
        wanted = "a pure number" if unit == "1" else f"a quantity in {unit}"
        raise UnitError(f"expected {wanted}, got {printable(text, most=60)!r}") from None
    return _finite(number * scale, words)


def _finite(value: float, text: str) -> float:
    if not math.isfinite(value):
        raise UnitError(f"{printable(text, most=60)} is not a finite number")
    return value
