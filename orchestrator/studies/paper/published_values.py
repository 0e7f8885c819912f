"""What the paper states, and what our number beside it is: read from `scenarios/paper/`."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, Literal

MarkKind = Literal["predicted", "calibrated", "undecidable", "arithmetic"]

SCALES = {
    "1": 1.0, "%": 1e-2, "mm": 1e-3, "Hz": 1.0, "deg": math.pi / 180.0, "N/m": 1.0, "mW": 1e-3,
    "W": 1.0, "W/kg": 1.0, "mg": 1e-6,
}  # fmt: skip
"""What a number in the paper's unit is multiplied by to be SI."""


@dataclass(frozen=True)
class Number:
    """A statement of the paper: a number in its own `unit`, or a claim in words."""

    quantity: str
    value: float | str
    unit: str
    kind: str
    where: str

    @property
    def scale(self) -> float:
        """SI units in one of the paper's."""
        return SCALES[self.unit]


@dataclass(frozen=True)
class Mark:
    """What our number rests on: `calibrated` ones are no predictions, whatever their error.

    `band` is its relative standard deviation that follows from those of the data that were fitted
    (`resilin calibrate`); None where none was worked out.
    """

    kind: MarkKind
    basis: str
    band: float | None = None


def number(key: str) -> Number:
    """The paper's statement under `item.name`."""
    found = _entry("numbers", key)
    return Number(
        quantity=str(found["quantity"]),
        value=found["value"],
        unit=str(found.get("unit", "1")),
        kind=str(found["kind"]),
        where=str(found["where"]),
    )


def mark(key: str, model: str = "") -> Mark:
    """The mark under `item.name`; one `item.name` may mark `item.name_1`, `item.name_2` and so on.

    Where one model's number rests on other things than another's, `item.name_model` comes first.
    """
    item, _, name = key.partition(".")
    known = _read("marks")[item]
    stem = name.rpartition("_")[0]
    wanted = [f"{name}_{model}", f"{stem}_{model}"] if model else []
    found = next(known[each] for each in (*wanted, name, stem) if each in known)
    return Mark(
        found["mark"], str(found["basis"]), published_band(f"{key}_{model}" if model else key)
    )


def published_band(key: str) -> float | None:
    """Relative standard deviation of our number under `item.name`, or `item.name_model`."""
    item, _, name = key.partition(".")
    found: float | None = _read("bands").get(item, {}).get(name)
    return found


def given(name: str) -> Any:
    """A design value of the paper, SI."""
    return _read("numbers")["given"][name]


def readings() -> list[dict[str, Any]]:
    """Readings of figure 11, with verdicts and reasons."""
    return list(_read("readings")["readings"])


def profile() -> dict[str, Any]:
    """Profile of the vehicle's fit over the share of the film's force: see its file."""
    return _read("profile")


def keys(item: str) -> list[str]:
    """Names of all that the paper states for one item."""
    return [f"{item}.{name}" for name in _read("numbers").get(item, {})]


def _entry(file: str, key: str) -> dict[str, Any]:
    item, _, name = key.partition(".")
    found: dict[str, Any] = _read(file)[item][name]
    return found


@cache
def _read(file: str) -> dict[str, Any]:
    text = (resources.files("scenarios") / "paper" / f"{file}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)
