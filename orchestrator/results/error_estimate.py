"""How wrong a run is: its distance from the same run at half its communication steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

BEYOND = 4.0 / 3.0
"""Error over distance for a method of second order, 2^p/(2^p - 1).

First order has 2, third 1.14: from order 1/2 upwards the estimate is within a factor of 2.6.
"""


@dataclass(frozen=True)
class Estimate:
    """Estimated largest error of a variable over a run, absolute and by its largest value."""

    error: float
    relative: float


def estimate(series: NDArray[np.float64], halved: NDArray[np.float64]) -> Estimate:
    """Error of `series` from the same values at half the communication steps.

    With an error C h^p the distance d of the two is (1 - 2^-p) C h^p, so the error is
    d 2^p/(2^p - 1); see `BEYOND`. Errors that both runs have in common are not in it: those of
    the instances' own solvers, and the physics that the parts leave out.
    """
    error = BEYOND * float(np.abs(series - halved).max(initial=0.0))
    largest = float(np.abs(series).max(initial=0.0))
    return Estimate(error, error / largest if largest else 0.0)


def halved(points: Sequence[float]) -> list[float]:
    """Communication points with one more in the middle of each step."""
    ends = np.asarray(points, dtype=float)
    both = np.empty(2 * len(ends) - 1)
    both[::2] = ends
    both[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return both.tolist()
