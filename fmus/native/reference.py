"""The monolith's right-hand side, compiled: a reference solution at speed.

    derivative = right_hand_side(composition, amplifier.Input(), inside)
    solve_ivp(derivative, (t0, t1), y0, method="DOP853", rtol=1e-10)

It is `fmus.monolith.equations.rates` in C, bit by bit. Compiled once on a machine, for all
compositions: the library is kept under the user's cache folder by the digest of its sources.
"""

from __future__ import annotations

import ctypes
import dataclasses
import functools
import hashlib
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..amplifier.physics import Input
from ..generated import cache, keep
from ..monolith import equations
from ..monolith.equations import Composition, Vector
from . import table
from .link import FLAGS, PLATFORMS, compiled, compiler, own_platform
from .package import HERE
from .translate import unit, words

Array = NDArray[np.float64]


def right_hand_side(
    composition: Composition, u: Input, inside: float
) -> Callable[[float, Array], Array]:
    """dy/dt over one smooth piece of the drive; the entries are `equations.FIELDS`.

    A trial state outside the model gives NaN, on which a solver shortens its step. Raises
    :class:`NativeError` where there is no C compiler and no library from before.
    """
    rates = _library().reference_rates
    rates.restype = ctypes.c_char_p
    rates.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
    constants = np.array([*_flat(composition), *_flat(u), inside])
    state, after = np.empty((2, len(equations.FIELDS)))
    given, read, written = (a.ctypes.data_as(ctypes.c_void_p) for a in (constants, state, after))

    def derivative(t: float, y: Array) -> Array:
        state[:] = y
        cause = rates(given, t, read, written)
        if cause in _OUTSIDE:
            raise ArithmeticError(f"at t = {t} s: {cause.decode()}")
        if cause is not None:
            after.fill(np.nan)
        return after.copy()

    return derivative


_OUTSIDE = {
    text.encode()
    for name, text in words.words().items()
    if name.startswith("ZERO") or name == "OUT_OF_RANGE"
}
"""Causes that no state of the model can have: no solver would step around them."""


def _flat(record: Any) -> list[float]:
    """The floats of a record of floats and records, in order."""
    values: list[float] = []
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        values += [value] if isinstance(value, float) else _flat(value)
    return values


def sources() -> dict[str, str]:
    """File name -> text of all that the library is made of."""
    records = {"Composition": Composition, "Vector": Vector, "Input": Input}
    translation = unit.translated(equations, "equations", ["rates"], records)
    return {
        "reference.c": (HERE / "reference.c").read_text(encoding="utf-8"),
        "semantics.h": (HERE / "semantics.h").read_text(encoding="utf-8"),
        "words.h": words.header(),
        "part.h": "\n".join([*table.records(translation), ""]),
        "equations.h": translation.header,
        "equations.c": translation.source,
    }


@functools.cache
def _library() -> ctypes.CDLL:
    """The library, from the cache or made now."""
    texts = sources()
    digest = hashlib.sha256(" ".join(FLAGS).encode())
    for name, text in texts.items():
        digest.update(name.encode() + b"\0" + text.encode() + b"\0")
    platform = PLATFORMS[own_platform()]
    place = cache() / f"{digest.hexdigest()[:16]}-equations{platform.suffix}"
    if place.is_file():
        return ctypes.CDLL(str(place))
    with tempfile.TemporaryDirectory(prefix="resilin_build_") as folder:
        for name, text in texts.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        files = [Path(folder) / name for name in texts if name.endswith(".c")]
        library = Path(folder) / place.name
        compiled(files, library, compiler(platform.targets[0], own=True))
        kept = keep(place, library.read_bytes())
        return ctypes.CDLL(str(place if kept else library))
