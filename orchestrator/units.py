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
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from .errors import printable

_SYMBOL = r"[A-Za-zµμΩ%°]+(?:(?:\*\*|\^)?-?[0-9])?"
_FACTOR = rf"\(?(?:1|{_SYMBOL})\)?"
_UNIT = re.compile(rf"{_FACTOR}(?:\s*[*/.·]\s*{_FACTOR})*")
"""Products of symbols with one-digit exponents; nothing that a parser would have to compute."""
_SCALED = re.compile(r"(\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)(?:\s+(\S.*))?")
"""A number of such a product, `0.0174533 rad`; or a number alone."""

OFFSET_UNITS = ("degC", "degF", "celsius", "fahrenheit")

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
"""Base units of FMI and SSP. The radian is one of them: 1 Hz is not 1 rad/s."""
_BASES = (*BASES, "bit")
ANGLE = BASES.index("rad")
ROUNDED = 1e-5
"""Largest relative difference of a factor that counts as rounding, where a file declares it."""

PURE = {"", "1", "-", "--", "---", "n/a", "N/A"}
"""Spellings of the unit of a pure number."""
_SUPERSCRIPTS = str.maketrans("²³⁴⁻¹", "234-1")
_WORDS = {
    *("second", "seconds", "sec", "volt", "volts", "ampere", "amperes", "amp", "amps"),
    *("newton", "newtons", "metre", "metres", "meter", "meters", "degree", "degrees", "hertz"),
    *("pascal", "watt", "watts", "ohm", "ohms", "radian", "radians", "minute", "minutes"),
}
"""Units that are read whatever their case; symbols are not: `S` is siemens, `s` second."""


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


@dataclass(frozen=True)
class Definition:
    """A unit by base units: exponents of `BASES` and the bit; base = factor * number + offset."""

    powers: tuple[int, ...]
    factor: float = 1.0
    offset: float = 0.0

    @classmethod
    def of(cls, attributes: Mapping[str, str]) -> Definition:
        """From the attributes of a `BaseUnit` of FMI or SSP; `ValueError` for what is no number."""
        powers = tuple(int(attributes.get(base, "0")) for base in _BASES)
        scale, shift = (float(attributes.get(k, d)) for k, d in (("factor", "1"), ("offset", "0")))
        if not (math.isfinite(scale) and math.isfinite(shift) and scale != 0.0):
            raise ValueError(f"factor {scale}, offset {shift}")
        return cls(powers, scale, shift)

    def text(self) -> str:
        """Text for which `definition` gives this back; with an offset one that it refuses."""
        over, under = (
            [
                f"{base}{'' if abs(power) == 1 else abs(power)}"
                for base, power in zip(_BASES, self.powers, strict=True)
                if sign * power > 0
            ]
            for sign in (1, -1)
        )
        unit = "/".join([".".join(over) or "1", *under])
        if self.factor != 1.0:
            unit = repr(self.factor) if unit == "1" else f"{self.factor!r} {unit}"
        return f"{unit} @ {self.offset!r}" if self.offset else unit


def _spelt(unit: str) -> str:
    """An FMI unit, or one as instruments write it, as pint writes it."""
    if unit in PURE:
        return "dimensionless"
    text = unit.translate(_SUPERSCRIPTS)
    text = re.sub(r"(?<=[A-Za-z])-(?=[A-Za-z])", "*", text)
    if not (len(text) <= 60 and _UNIT.fullmatch(text)):
        raise UnitError(f"{printable(unit, most=60)!r} is not a product of units")
    text = re.sub(r"([A-Za-zµμΩ°%])(-?\d)", r"\1**\2", text)
    # for pint, Nm is a nautical mile
    text = re.sub(r"\b([A-Za-zµμ]?N)(m{1,2}(?:\*\*-?\d)?)\b", r"(\1*\2)", text)
    text = re.sub(r"°(?![CF])", "deg", text.replace("·", "*").replace(".", "*"))
    text = text.replace("Ohm", "ohm")
    return re.sub(r"[A-Za-z]+", lambda w: w[0].lower() if w[0].lower() in _WORDS else w[0], text)


def _read(unit: str) -> list[Any]:
    """Exponents, factor and offset of a unit, by pint."""
    scaled = _SCALED.fullmatch(unit)
    scale, symbols = (float(scaled[1]), scaled[2] or "") if scaled else (1.0, unit)
    text = _spelt(symbols)
    registry = _registry()
    try:
        one = registry.Unit(text)
        zero, base = (registry.Quantity(n, one).to_base_units() for n in (0.0, 1.0))
    except Exception as error:
        raise UnitError(f"unknown unit {unit!r} ({printable(str(error))})") from None
    powers = dict.fromkeys(_BASES, 0)
    for name, power in base.unit_items():
        if name not in _PINT_BASES or power != int(power):
            raise UnitError(f"{unit!r} has no whole powers of {', '.join(_BASES)}")
        powers[_PINT_BASES[name]] = int(power)
    offset = float(zero.magnitude)
    return [*powers.values(), scale * (float(base.magnitude) - offset), offset]


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


def definition(unit: str) -> Definition:
    """What a unit means by its name; `UnitError` where it is not known."""
    *powers, scale, offset = _asked(("unit", unit), lambda: _read(unit))
    return Definition(tuple(powers), scale, offset)


def declared(name: str, meaning: Definition) -> str:
    """Text for a unit of a file that declares what its name means.

    The name, where that is read as what is declared, else the base units with their factor:
    `1/min` declared as 0.10472 rad/s is `0.10472 rad/s`. A declaration that leaves out the radian
    is taken as the name has it.
    """
    try:
        known = definition(name)
    except UnitError:
        return meaning.text()
    bases = known.powers[:ANGLE] == meaning.powers[:ANGLE]
    angle = meaning.powers[ANGLE] in (0, known.powers[ANGLE])
    alike = math.isclose(known.factor, meaning.factor, rel_tol=ROUNDED) and math.isclose(
        known.offset, meaning.offset, rel_tol=ROUNDED
    )
    return name if bases and angle and alike else meaning.text()


def check_unit(unit: str) -> None:
    """`UnitError` where a unit is not known."""
    definition(unit)


def factor(from_unit: str, to_unit: str) -> float:
    """Factor that converts a number from one unit to the other.

    Raises `UnitError` where the base units differ, the radian included, or where a conversion
    would need an offset (degrees Celsius): such a wire is ambiguous between value and difference.
    """
    if from_unit == to_unit:
        return 1.0
    one, other = definition(from_unit), definition(to_unit)
    if one.powers != other.powers:
        raise UnitError(f"{from_unit or '1'} is not convertible to {to_unit or '1'}")
    if one.offset or other.offset:
        raise UnitError(f"{from_unit} to {to_unit} needs an offset: state gain and offset")
    return one.factor / other.factor


def is_power(unit: str) -> bool:
    """Whether a unit is one of power, with or without radians: `N.m.rad/s` is."""
    return definition(unit).powers[:ANGLE] == definition("W").powers[:ANGLE]


_NAMED = ("1", "m", "s", "kg", "A", "K", "rad", "Hz", "N", "Pa", "J", "W", "C", "V", "Ohm", "F")
_PINT_BASES = {
    "kilogram": "kg", "meter": "m", "second": "s", "ampere": "A", "kelvin": "K", "mole": "mol",
    "candela": "cd", "radian": "rad", "bit": "bit",
}  # fmt: skip


def in_base(unit: str) -> tuple[str, float]:
    """The SI unit of the same dimension as FMI writes it, and how many of it one `unit` is.

    `V` and `m/s` stay what they are, `mN` becomes `N`, `g*mm` `kg.m`. Raises `UnitError` for
    what is not a unit, and for degrees Celsius and Fahrenheit.
    """
    one = definition(unit)
    if one.offset:
        raise UnitError(f"{unit} needs an offset: give kelvin")
    for name in _NAMED:
        if definition(name).powers == one.powers:
            return name, one.factor
    return Definition(one.powers).text(), one.factor


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
