"""An animation of a page: outlines whose points move from frame to frame, beside curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from .plot import Plot, plotted, short

Kind = Literal["fixed", "film", "spacer", "link", "wing", "joint"]

PLACES = 4
"""Decimals of a coordinate, in the unit of the view: no screen shows more."""


@dataclass(frozen=True)
class Body:
    """One outline. `x` and `y` are lists of frames, each of points; one frame alone stands still.

    `level`, between 0 and 1 for each frame, is shown as how full its colour is.
    """

    name: str
    kind: Kind
    x: Sequence[Sequence[float]]
    y: Sequence[Sequence[float]]
    level: Sequence[float] = ()


@dataclass(frozen=True)
class Label:
    """A text at a fixed place, with a line to the mean of some points of the body of that name."""

    text: str
    place: tuple[float, float]
    body: str
    points: Sequence[int]


@dataclass(frozen=True)
class View:
    """Bodies seen through a window (x0, y0, x1, y1), all in millimetres, beside a scale bar."""

    title: str
    window: tuple[float, float, float, float]
    bodies: Sequence[Body]
    labels: Sequence[Label] = ()


@dataclass(frozen=True)
class Animation:
    """Views that move together and plots over the same time, with a cursor where they are.

    It plays by itself where the reader has not asked for less motion; the plots are folded.
    `times` [s] are those of the frames; the last is the first again, one period later. The
    plots' x axis is in milliseconds from the first frame.
    """

    kind: ClassVar[str] = "animation"
    key: str
    title: str
    caption: str
    times: Sequence[float]
    views: Sequence[View]
    plots: Sequence[Plot]

    def data(self) -> dict[str, Any]:
        """The animation as JSON, in the shape that the page's script reads."""
        first = self.times[0]
        return {
            "title": self.title,
            "times": short(1e3 * (time - first) for time in self.times),
            "views": [
                {
                    "title": view.title,
                    "window": list(view.window),
                    "bodies": [_body(body) for body in view.bodies],
                    "labels": [_label(label, view.bodies) for label in view.labels],
                }
                for view in self.views
            ],
            "plots": [plotted(plot) for plot in self.plots],
        }


def _body(body: Body) -> dict[str, Any]:
    return {
        "name": body.name,
        "kind": body.kind,
        "x": [_places(frame) for frame in body.x],
        "y": [_places(frame) for frame in body.y],
        "level": short(body.level),
    }


def _label(label: Label, bodies: Sequence[Body]) -> dict[str, Any]:
    (x, y), names = label.place, [body.name for body in bodies]
    body, points = names.index(label.body), list(label.points)
    return {"text": label.text, "x": x, "y": y, "body": body, "points": points}


def _places(frame: Sequence[float]) -> list[float]:
    return [round(float(value), PLACES) for value in frame]
