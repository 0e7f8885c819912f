"""Unit strings and their base-unit exponents."""

from __future__ import annotations

import pytest

from fmus.units import exponents


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("1", {}),
        ("N.s/m", {"kg": 1, "s": -1}),
        ("V2/s2", {"kg": 2, "m": 4, "s": -8, "A": -2}),
        ("kg.m2", {"kg": 1, "m": 2}),
        ("F", {"kg": -1, "m": -2, "s": 4, "A": 2}),
        ("rad/m", {"m": -1, "rad": 1}),
    ],
)
def test_exponents(unit: str, expected: dict[str, int]) -> None:
    assert exponents(unit) == expected


@pytest.mark.parametrize("unit", ["", "furlong", "N m", "N..m", "2", "m^2"])
def test_what_is_no_unit(unit: str) -> None:
    with pytest.raises(ValueError, match="not a product"):
        exponents(unit)
