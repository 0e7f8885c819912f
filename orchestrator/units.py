"""Conversion of units: texts such as `1.9 mm` to SI, by pint.

Inside the program, numbers are plain floats in SI. FMI writes products as `N.s/m` and `V2/s2`.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import math
import os
import re
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

from .errors import printable

_SYMBOL = r"[A-Za-zµμΩ%°]+(?:(?:\*\*|\^)?-?[0-9])?"
_FACTOR = rf"\(?(?:1|{_SYMBOL})\)?"
_UNIT = re.compile(rf"{_FACTOR}(?:\s*[*/.·]\s*{_FACTOR})*")
"""Products of symbols with one-digit exponents; nothing that a parser would have to compute."""

OFFSET_UNITS = ("degC", "degF", "celsius", "fahrenheit")


class Answers:
    """What pint has answered before, in a file of the user's cache: loading pint takes long.

    They are kept under the version of pint and of this file.
    """

    def __init__(self) -> None:
        self._known: dict[str, list[Any]] | None = None

    def known(self, *question: str) -> list[Any] | None:
        """The answer to a question; None where it has not been asked yet."""
        return self._table().get("\n".join(question))

    def keep(self, answer: list[Any], *question: str) -> None:
        """Add an answer; where the file cannot be written, it is asked again next time."""
        table = self._table()
        table["\n".join(question)] = answer
        path = self._path()
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False) as file:
                json.dump(table, file)
            Path(file.name).replace(path)

    def _table(self) -> dict[str, list[Any]]:
        if self._known is None:
            try:
                found = json.loads(self._path().read_text(encoding="utf-8"))
                self._known = found if isinstance(found, dict) else {}
            except (OSError, ValueError):
                self._known = {}
        return self._known

    @staticmethod
    @functools.cache
    def _path() -> Path:
        digest = hashlib.sha256(Path(__file__).read_bytes())
        digest.update(metadata.version("pint").encode())
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "resilin"
        return root / f"units-{digest.hexdigest()[:16]}.json"


answers = Answers()
REFUSED = "refused"


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


def _asked(question: tuple[str, ...], ask: Callable[[], list[Any]]) -> list[Any]:
    """The answer to a question, from the cache or from pint; refusals are answers too."""
    known = answers.known(*question)
    if known is None:
        try:
            known = ask()
        except UnitError as error:
            known = [REFUSED, str(error)]
        answers.keep(known, *question)
    if known[0] == REFUSED:
        raise UnitError(known[1])
    return known


def check_unit(unit: str) -> None:
    """`UnitError` where a unit is not known."""
    _asked(("unit", unit), lambda: [str(parsed(unit))])


def factor(from_unit: str, to_unit: str) -> float:
    """Factor that converts a number from one unit to the other.

    Raises `UnitError` where the dimensions differ, or where a conversion would need an
    offset (degrees Celsius): such a wire is ambiguous between value and difference.
    """
    if from_unit == to_unit:
        return 1.0
    found = _asked(("factor", from_unit, to_unit), lambda: [_factor(from_unit, to_unit)])
    return float(found[0])


def _factor(from_unit: str, to_unit: str) -> float:
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
    name, size = _asked(("base", unit), lambda: list(_in_base(unit)))
    return str(name), float(size)


def _in_base(unit: str) -> tuple[str, float]:
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
