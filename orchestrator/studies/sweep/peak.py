"""The largest value over an axis, found by bisecting beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

FINEST = 1.0 / 8.0
"""Smallest spacing beside the peak, of that of the grid."""

UNCHANGED = 1e-3
"""Relative change of the parabola's peak below which refining ends."""


@dataclass(frozen=True)
class Peak:
    """Where the largest value is, and what it is."""

    at: float
    value: float

    def like(self, other: Peak, near: float) -> bool:
        """Whether another estimate is the same: in value to `UNCHANGED`, in place to `near`."""
        unchanged = abs(self.value - other.value) <= UNCHANGED * abs(self.value)
        return unchanged and abs(self.at - other.at) <= near


def peak_of(values: Mapping[float, float]) -> Peak | None:
    """Vertex of the parabola through the largest value and its neighbours.

    The largest value itself where it is at an end, or beside a point without a value (NaN); None
    where no point has one.
    """
    places, k = _largest(values)
    if k is None:
        return None
    top = Peak(places[k], values[places[k]])
    if not 0 < k < len(places) - 1:
        return top
    x0, x1, x2 = places[k - 1 : k + 2]
    left = (values[x1] - values[x0]) / (x1 - x0)
    right = (values[x2] - values[x1]) / (x2 - x1)
    bend = (right - left) / (x2 - x0)
    if not bend < 0.0:
        return top
    slope = left + bend * (x1 - x0)
    shift = -0.5 * slope / bend
    return Peak(x1 + shift, top.value + 0.5 * slope * shift)


def uncertainty_of(values: Mapping[float, float]) -> Peak | None:
    """How far the vertex may be from the true peak, in place and in value.

    The parabola is compared with the cubic through one more point on either side: the next term of
    Newton's interpolation. A place is at most as uncertain as the vertex is far from the
    neighbours. None where the largest value has none on both sides, or there is no fourth point.
    """
    places, k = _largest(values)
    peak = peak_of(values)
    if k is None or peak is None or not 0 < k < len(places) - 1:
        return None
    near = places[k - 1 : k + 2]
    bend = _divided(near, values)
    beside = [places[n] for n in (k - 2, k + 2) if 0 <= n < len(places)]
    thirds = [_divided([*near, place], values) for place in beside]
    third = max((abs(each) for each in thirds if math.isfinite(each)), default=math.nan)
    if not (bend < 0.0 and math.isfinite(third)):
        return None
    a, b, c = (peak.at - place for place in near)
    slope = third * abs(b * c + a * c + a * b)
    return Peak(min(-0.5 * slope / bend, max(a, -c)), third * abs(a * b * c))


def _divided(places: Sequence[float], values: Mapping[float, float]) -> float:
    """Divided difference over all of the places."""
    if len(places) == 1:
        return values[places[0]]
    rise = _divided(places[1:], values) - _divided(places[:-1], values)
    return rise / (places[-1] - places[0])


def spacing(values: Mapping[float, float]) -> float:
    """Widest gap beside the largest value; 0 where there is none."""
    return max((b - a for a, b in _beside(values)), default=0.0)


def middles(values: Mapping[float, float], finest: float, *, whole: bool = False) -> list[float]:
    """Middles of the gaps beside the largest value that are wider than `finest`.

    With `whole` they are whole numbers, where the gap has one inside.
    """
    found = []
    for a, b in _beside(values):
        middle = 0.5 * (a + b)
        middle = float(math.floor(middle)) if whole else middle
        if b - a > finest * (1.0 + 1e-9) and a < middle < b:
            found.append(middle)
    return found


def _beside(values: Mapping[float, float]) -> list[tuple[float, float]]:
    """Gaps to the left and right of the largest value."""
    places, k = _largest(values)
    if k is None:
        return []
    return list(pairwise(places[max(0, k - 1) : k + 2]))


def _largest(values: Mapping[float, float]) -> tuple[list[float], int | None]:
    """Places in order, and the index of the largest value among them."""
    places = sorted(values)
    known = [k for k, place in enumerate(places) if not math.isnan(values[place])]
    return places, max(known, key=lambda k: values[places[k]], default=None)
