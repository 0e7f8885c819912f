"""A figure or table of the paper, reproduced: rows that stand beside its numbers, and plots."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from ...report.animation import Animation
from ...report.plot import Figure
from ...report.table import Table
from .cached_runs import Measured
from .published_values import Mark, Number, mark, number


@dataclass(frozen=True)
class Row:
    """Ours beside a statement of the paper, under the key of that statement.

    `ours` is SI, or words beside a claim, which it `agrees` with or not. `doubt` is the
    numerical error (half step, or the frequencies' spacing), SI. `reading` says which of the
    readings this is, where the text leaves several; `model` which of ours it is, where its mark
    differs from that of the others.
    """

    key: str
    ours: float | str
    reading: str = ""
    doubt: float = math.nan
    scenario: str = ""
    wall_time: float = math.nan
    agrees: bool | None = None
    model: str = ""

    @property
    def number(self) -> Number:
        """What the paper states."""
        return number(self.key)

    @property
    def mark(self) -> Mark:
        """What ours rests on."""
        return mark(self.key, self.model)

    @property
    def error(self) -> float:
        """Relative error of ours against the paper's; NaN beside a claim."""
        stated = self.number
        if isinstance(stated.value, str) or isinstance(self.ours, str):
            return math.nan
        return self.ours / (stated.value * stated.scale) - 1.0

    @property
    def held(self) -> bool | None:
        """Whether the band holds the paper's value; None without one, and for what is calibrated.

        The paper's value is one of the data that a calibrated number was fitted to.
        """
        band = self.mark.band
        if band is None or self.mark.kind == "calibrated" or not math.isfinite(self.error):
            return None
        return abs(self.error) <= band

    def facts(self) -> dict[str, Any]:
        """The row for scripts, in the paper's unit."""
        stated, ours = self.number, self.ours
        scale = stated.scale
        return {
            "item": self.key.partition(".")[0],
            "key": self.key,
            "quantity": stated.quantity,
            "reading": self.reading,
            "unit": stated.unit,
            "paper": stated.value,
            "paper_kind": stated.kind,
            "where": stated.where,
            "ours": ours if isinstance(ours, str) else float(ours) / scale,
            "relative_error": float(self.error),
            "agrees": self.agrees,
            "mark": self.mark.kind,
            "basis": self.mark.basis,
            "band": self.mark.band,
            "band_holds": self.held,
            "numerical_error": float(self.doubt) / scale,
            "scenario": self.scenario,
            "wall_time": float(self.wall_time),
        }


@dataclass(frozen=True)
class Comparison:
    """What one figure or table comes to, or a section beyond the paper, which has no `rows`.

    `extras` come after the figures; `failures` are the runs that stopped, in words.
    """

    key: str
    title: str
    words: Sequence[str]
    rows: Sequence[Row]
    figures: Sequence[Figure] = field(default_factory=tuple)
    failures: Sequence[str] = field(default_factory=tuple)
    extras: Sequence[Table | Animation] = field(default_factory=tuple)


def row(key: str, found: Measured, scenario: str, reading: str = "", model: str = "") -> Row:
    """A row of a measured value."""
    return Row(
        key, float(found.value), reading, float(found.doubt), scenario, found.wall_time, model=model
    )
