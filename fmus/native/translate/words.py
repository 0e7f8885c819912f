"""The words of errors that Python itself raises, as the slave reports them: in this Python's own.

A `ValueError` is reported by its text, any other exception by its `repr`, as `fmus/slave.py` does.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

from .text import quoted

_EMPTY: tuple[float, ...] = ()
_RAISED: dict[str, Callable[[float], object]] = {
    "ZERO_DIVISION": lambda zero: 1.0 / zero,
    "ZERO_FLOOR": lambda zero: 1.0 // zero,
    "ZERO_MODULO": lambda zero: 1.0 % zero,
    "ZERO_WHOLE_FLOOR": lambda zero: 1 // int(zero),
    "ZERO_WHOLE_MODULO": lambda zero: 1 % int(zero),
    "OUT_OF_RANGE": lambda zero: _EMPTY[int(zero)],
    "DOMAIN_ERROR": lambda zero: math.fmod(math.inf, 1.0 + zero),
    "RANGE_ERROR": lambda zero: math.exp(1e4 + zero),
    "INFINITE_TO_WHOLE": lambda zero: int(math.inf + zero),
    "NAN_TO_WHOLE": lambda zero: int(math.nan + zero),
}


@functools.cache
def words() -> dict[str, str]:
    """Name of a cause in C -> what the slave reports."""
    return {name: _reported(raised) for name, raised in _RAISED.items()}


def _reported(raised: Callable[[float], object]) -> str:
    try:
        raised(0.0)
    except (ValueError, OverflowError, ZeroDivisionError, IndexError) as error:
        return str(error) if isinstance(error, ValueError) else repr(error)
    raise AssertionError("nothing was raised")


def header() -> str:
    """The file `words.h`."""
    lines = ["/* What Python calls the errors that it raises itself; made by the build. */"]
    lines += [f"#define {name} {quoted(text)}" for name, text in words().items()]
    return "\n".join([*lines, ""])
