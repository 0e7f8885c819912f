"""Checks that neither schema makes: names, start values, bounds, units."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from ...errors import printable
from .variable import WHOLE

BOUNDED = ("Real", "Float64", "Float32", "Enumeration", *WHOLE)
"""Elements whose start, min, max and nominal are numbers."""


def name_faults(name: str, seen: set[str]) -> list[str]:
    """What is wrong with a variable's name, which is added to `seen`."""
    found = []
    if not name or printable(name, most=1000) != name:
        found.append("has an empty or unprintable name")
    if name in seen:
        found.append("is duplicated")
    seen.add(name)
    return found


def faults(typed: Any, units: Iterable[str | None]) -> list[str]:
    """What is wrong with start, min, max and unit of one typed element."""
    found = []
    numbers: dict[str, float] = {}
    for key in ("start", "min", "max", "nominal"):
        text = typed.get(key)
        if text is None or typed.tag not in BOUNDED:
            continue
        for word in text.split() or [text]:
            try:
                numbers[key] = float(word)
            except ValueError:
                found.append(f"has {key} {printable(word)!r}, which is not a number")
                break
            if not math.isfinite(numbers[key]):
                found.append(f"has {key} {printable(word)}, which is not finite")
    if numbers.get("min", -math.inf) > numbers.get("max", math.inf):
        found.append("has min above max")
    unit = typed.get("unit")
    if unit is not None and unit not in units:
        found.append(f"has unit '{printable(unit)}', which is not defined")
    return found
