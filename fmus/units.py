"""Unit strings as base-unit exponents, the form FMI asks for.

A unit is a product written with `.` and `/`, each factor a symbol with an optional
whole exponent: `N.s/m`, `V2/s2`, `kg.m2`. A slash divides by the one factor behind it.
"""

from __future__ import annotations

import re

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

SYMBOLS: dict[str, dict[str, int]] = {
    **{base: {base: 1} for base in BASES},
    "1": {},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "C": {"s": 1, "A": 1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "Ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
}

_FACTOR = re.compile(r"(?P<slash>[./]?)(?P<symbol>[A-Za-z]+|1)(?P<power>\d*)")


def exponents(unit: str) -> dict[str, int]:
    """Base unit -> exponent, zeros left out; `ValueError` on a unit outside this table."""
    total: dict[str, int] = {}
    place = 0
    for factor in _FACTOR.finditer(unit):
        if factor.start() != place or factor["symbol"] not in SYMBOLS:
            break
        place = factor.end()
        power = int(factor["power"] or 1) * (-1 if factor["slash"] == "/" else 1)
        for base, exponent in SYMBOLS[factor["symbol"]].items():
            total[base] = total.get(base, 0) + power * exponent
    if place != len(unit) or not unit:
        raise ValueError(f"unit {unit!r} is not a product of {', '.join(SYMBOLS)}")
    return {base: total[base] for base in BASES if total.get(base)}
