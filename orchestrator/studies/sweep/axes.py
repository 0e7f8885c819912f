"""Axes of a sweep: `component.parameter=values`, as ranges or lists of texts with units."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext

from ...errors import InputError, printable

MOST_POINTS = 100_000
DIGITS = 40
"""Decimal digits in which a range is laid out, so that 0:1:0.1 meets 0.3 and 1 exactly."""

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = r"[A-Za-zµμΩ%°][^:,]*?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*({_UNIT})?")
_QUANTITY_AND_COUNT = re.compile(rf"({_NUMBER})\s*({_UNIT})?\s*/\s*(\d+)\s*({_UNIT})?")
FORMS = "write start:stop:step as 1:100:5Hz, start:stop/count as 1:50/26Hz, or a list as 2,4,6"


@dataclass(frozen=True)
class Axis:
    """A start value, named `component.parameter`, and its values on the axis: texts with units."""

    name: str
    values: tuple[str, ...]


def parse_axis(text: str) -> Axis:
    """An axis from `component.parameter=start:stop:step unit`, `=start:stop/count unit` or a list.

    The stop belongs to a range where the steps meet it. A unit is written once, at the end, or
    the same on every number. `InputError` names what is wrong, and how it is written.
    """
    name, equals, values = (part.strip() for part in text.partition("="))
    component, _, parameter = name.partition(".")
    if not (equals and component and parameter):
        raise InputError(f"axis {printable(text)!r}: write component.parameter=values; {FORMS}")
    try:
        found = _range(values) if ":" in values else _list(values)
    except _Malformed as error:
        raise InputError(f"axis {printable(text)!r}: {error}") from None
    return Axis(name, tuple(found))


def check_axes(axes: Sequence[Axis], changes: dict[str, str]) -> None:
    """Refuse what does not make a sweep: no axis, one parameter twice, too many points."""
    if not axes:
        raise InputError(f"a sweep needs at least one axis; {FORMS}")
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"axis {printable(name)}: is given twice; give all its values in one")
        if name in changes:
            raise InputError(
                f"axis {printable(name)}: is set to {changes[name]!r} as well; drop one"
            )
    count = math.prod(len(axis.values) for axis in axes)
    if count > MOST_POINTS:
        sizes = " x ".join(str(len(axis.values)) for axis in axes)
        raise InputError(f"{sizes} = {count} points; at most {MOST_POINTS} go into one sweep")


class _Malformed(ValueError):
    """What is wrong with the values of an axis."""


def _range(text: str) -> list[str]:
    """Texts of start:stop:step or start:stop/count."""
    parts = [part.strip() for part in text.split(":")]
    counted = _QUANTITY_AND_COUNT.fullmatch(parts[-1]) if len(parts) == 2 else None
    first = _QUANTITY.fullmatch(parts[0])
    if counted and first:
        unit = _common([first[2], counted[2] or counted[4]], counted[4])
        return _with_unit(_even(_number(first[1]), _number(counted[1]), counted[3]), unit)
    found = [_QUANTITY.fullmatch(part) for part in parts]
    if len(found) != 3 or None in found:
        raise _Malformed(f"is not a range; {FORMS}")
    units = [match[2] for match in found if match]
    start, stop, step = (_number(match[1]) for match in found if match)
    return _with_unit(_stepped(start, stop, step), _common(units, units[-1]))


def _stepped(start: Decimal, stop: Decimal, step: Decimal) -> list[Decimal]:
    with localcontext() as context:
        context.prec = DIGITS
        if step <= 0:
            raise _Malformed(f"its step {step} must be above zero")
        _check_order(start, stop)
        steps = (stop - start) / step + Decimal("1e-9")
        if steps >= MOST_POINTS:
            raise _Malformed(f"has more than {MOST_POINTS} points")
        return [start + k * step for k in range(int(steps) + 1)]


def _even(start: Decimal, stop: Decimal, points: str) -> list[Decimal]:
    if len(points) > len(str(MOST_POINTS)) or int(points) > MOST_POINTS:
        raise _Malformed(f"has more than {MOST_POINTS} points")
    count = int(points)
    if count < 2:
        raise _Malformed(f"a range of {count} points; at least 2 span it")
    _check_order(start, stop)
    if start == stop:
        raise _Malformed(f"starts and stops at {start}: there is room for one point")
    with localcontext() as context:
        context.prec = DIGITS
        return [start + k * (stop - start) / (count - 1) for k in range(count)]


def _check_order(start: Decimal, stop: Decimal) -> None:
    if stop < start:
        raise _Malformed(f"runs backwards, from {start} to {stop}; swap them")


def _list(text: str) -> list[str]:
    """Texts of a comma-separated list: numbers with or without units, or plain texts."""
    items = [item.strip() for item in text.split(",")]
    if "" in items:
        raise _Malformed(f"has an empty value; {FORMS}")
    matches = [_QUANTITY.fullmatch(item) for item in items]
    quantities = [match for match in matches if match]
    if len(quantities) < len(items):
        bare = [match[0] for match in quantities if not match[2]]
        if bare:
            raise _Malformed(f"mixes numbers and texts: {bare[0]} is not a text")
        return _distinct(items, items)
    unit = _common([match[2] for match in quantities], quantities[-1][2])
    same = [_number(match[1]) for match in quantities]
    return _distinct(_with_unit([match[1] for match in quantities], unit), same)


def _distinct(texts: list[str], values: Sequence[object]) -> list[str]:
    if len(texts) > MOST_POINTS:
        raise _Malformed(f"has more than {MOST_POINTS} points")
    seen: set[object] = set()
    for text, value in zip(texts, values, strict=True):
        if value in seen:
            raise _Malformed(f"has {printable(text)!r} twice")
        seen.add(value)
    return texts


def _common(units: Sequence[str | None], last: str | None) -> str:
    """The one unit of an axis: the same on every number, or at the end alone."""
    given = {unit.strip() for unit in units if unit}
    everywhere = all(units)
    if len(given) > 1 or (given and not everywhere and not last):
        listed = ", ".join(sorted(printable(unit) for unit in given))
        raise _Malformed(f"mixes units ({listed}); write one unit, once, at the end")
    if given and not everywhere and sum(unit is not None for unit in units) > 1:
        raise _Malformed("has a unit on some numbers only; write it once, at the end")
    return given.pop() if given else ""


def _number(text: str) -> Decimal:
    if not math.isfinite(float(text)):
        raise _Malformed(f"{printable(text, most=60)} is not a finite number")
    return Decimal(text)


def _with_unit(numbers: Sequence[Decimal | str], unit: str) -> list[str]:
    texts = [n if isinstance(n, str) else repr(float(n)).removesuffix(".0") for n in numbers]
    return [f"{text} {unit}" if unit else text for text in texts]
