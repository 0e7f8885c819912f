"""The checked mathematics answers and raises as CPython does."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fmus.native import mathematics
from tests.fmus.test_rules import ALLOWED_MATH

VALUES = [
    0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 1.5, -2.5, 1e-300, -1e-300, 1e300, -1e300, 5e-324, 710.0,
    -710.0, 745.5, 2.0**52 + 1.0, 1e18, 1e19, -1e19, math.pi, math.inf, -math.inf, math.nan,
]  # fmt: skip
ONE = [*mathematics.BOUNDED, *mathematics.GROWING, "floor", "ceil", "asinh", "tanh"]


def answer(function: Callable[..., Any], *arguments: float) -> Any:
    """Bits of the result as a float, or the exception's kind and words."""
    try:
        return np.float64(function(*arguments)).tobytes()
    except (ValueError, OverflowError) as error:
        return type(error), str(error)


@pytest.mark.parametrize("name", ONE)
def test_functions_of_one_argument(name: str) -> None:
    checked = getattr(mathematics.checked(), name)
    plain = getattr(math, name)
    random = np.random.default_rng(5).normal(scale=3.0, size=500).tolist()
    for value in [*VALUES, *random]:
        if math.isnan(value) and name not in ("floor", "ceil"):
            assert math.isnan(checked(value))
        else:
            assert answer(checked, value) == answer(plain, value), value


def test_what_the_rules_allow_is_there() -> None:
    module = mathematics.checked()
    assert {name for name in vars(module) if not name.startswith("__")} == ALLOWED_MATH


def test_powers() -> None:
    for x in VALUES:
        for y in VALUES:
            if math.isfinite(x) and math.isfinite(y):
                ours, theirs = answer(mathematics.power, x, y), answer(math.pow, x, y)
                assert ours == theirs, (x, y)


def test_whole_numbers_saturate() -> None:
    for value in VALUES:
        if abs(value) < mathematics.BEYOND or not math.isfinite(value):
            ours, theirs = answer(mathematics.integer, value), answer(int, value)
            assert ours == theirs, value
    assert mathematics.integer(1e19) == mathematics.LARGEST
    assert mathematics.integer(-1e19) == -mathematics.LARGEST
