"""A plot of a page: curves over axes, as data; the page's script and matplotlib draw the same."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

Style = Literal["line", "dashed", "points", "line-points", "stated"]
DIGITS = 6
"""Significant digits of what a page carries: more than a screen can show."""


@dataclass(frozen=True)
class Axis:
    """A label with its unit; the ends of the axis, where the data do not set them."""

    label: str
    log: bool = False
    least: float | None = None
    most: float | None = None


@dataclass(frozen=True)
class Curve:
    """A named run of points; one that is not finite leaves a gap.

    `stated` points are crosses in the colour of the text: values that others have published.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    style: Style = "line"


@dataclass(frozen=True)
class Plot:
    """Curves over one pair of axes."""

    title: str
    x: Axis
    y: Axis
    curves: Sequence[Curve]


@dataclass(frozen=True)
class Figure:
    """Plots that belong together. `key` names the section's anchor and the file of the plots."""

    kind: ClassVar[str] = "figure"
    key: str
    title: str
    caption: str
    plots: Sequence[Plot]

    def data(self) -> list[dict[str, Any]]:
        """The plots as JSON, in the shape that the page's script reads."""
        return [plotted(plot) for plot in self.plots]


def plotted(plot: Plot) -> dict[str, Any]:
    """A plot as JSON."""
    return {
        "title": plot.title,
        "x": _axis(plot.x),
        "y": _axis(plot.y),
        "curves": [
            {"name": c.name, "style": c.style, "x": short(c.x), "y": short(c.y)}
            for c in plot.curves
        ],
    }


def short(values: Iterable[float]) -> list[float | None]:
    """Numbers to `DIGITS` significant digits; None for one that is not finite."""
    return [float(f"{v:.{DIGITS}g}") if math.isfinite(v) else None for v in map(float, values)]


def _axis(axis: Axis) -> dict[str, Any]:
    return {"label": axis.label, "log": axis.log, "least": axis.least, "most": axis.most}
