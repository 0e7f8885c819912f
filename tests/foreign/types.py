"""Scenarios of TYPES: inputs and expected outputs, by type."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tests.foreign.scenarios import Value, hold, part, scenario, wires

LARGEST = 2**53 - 1
"""Greatest whole number to which no other one rounds as a double."""
RANGES = {
    "integer": (-(2**31), 2**31 - 1),
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32)},
    "int64": (-LARGEST, LARGEST),
    "uint64": (0, LARGEST),
}
REALS = {"real": (0.1, -9.87e99), "float64": (0.1, -9.87e99)}
REALS["float32"] = (float(np.float32(0.1)), float(np.float32(3.4e38)))


def echoed(version: int, end: int) -> dict[str, tuple[float, float, float]]:
    """Input of a first TYPES, its output, and that of a second one behind it, by type."""
    found: dict[str, tuple[float, float, float]] = {}
    reals = ("real",) if version == 2 else ("float64", "float32")
    wholes = ("integer",) if version == 2 else tuple(set(RANGES) - {"integer"})
    for name in reals:
        found[name] = (REALS[name][end],) * 3
    for name in wholes:
        start = RANGES[name][end] - 2 * end
        found[name] = (start, start + 1, start + 2)
    found["boolean"] = (float(end), 1.0 - end, float(end))
    found["enumeration"] = (1.0 + end,) * 3
    return found


def as_held(name: str, value: float) -> Value:
    """A held value as a scenario writes it."""
    if name == "boolean":
        return bool(value)
    return ("slow", "fast")[int(value) - 1] if name == "enumeration" else value


def typed(
    folder: Path,
    fmu: Path,
    version: int,
    *texts: str,
    start: Mapping[str, Value] | None = None,
    isolate: bool = False,
    held: Mapping[str, Value] | None = None,
) -> Path:
    """A scenario with a TYPES `a` and a TYPES `b`; inputs that no text wires are held."""
    names = {*echoed(version, 0)} | ({f"array[{k}]" for k in (1, 2, 3)} if version == 3 else set())
    fed = " ".join(texts) + " "
    usual = {
        f"{instance}.in_{name}": as_held(name, 1.0)
        for instance in "ab"
        for name in names
        if f"-> {instance}.in_{name} " not in fed
    }
    parts = [part("a", fmu, isolate=isolate, start=start or {}), part("b", fmu, isolate=False)]
    return scenario(folder, *parts, wires(*texts), hold({**usual, **(held or {})}), stop=0.02)
