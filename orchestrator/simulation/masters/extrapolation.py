"""Values at the last communication points, and weights of the polynomials through them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..coupled_instance import Values


class Past:
    """The last `most` communication points, newest first."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.times: tuple[float, ...] = ()
        self.values: tuple[Values, ...] = ()

    def note(self, time: float, values: Values) -> None:
        """Add a communication point; the newest is replaced where it has the same time."""
        keep = 1 if self.times and self.times[0] == time else 0
        self.times = (time, *self.times[keep:])[: self.most]
        self.values = (values.copy(), *self.values[keep:])[: self.most]

    def forget(self) -> None:
        """Drop all points."""
        self.times, self.values = (), ()


def mean_weights(times: Sequence[float], begin: float, end: float) -> Values:
    """Weights of values at `times` in the mean over [begin, end] of the polynomial through them.

    Two points before the interval give (1.5, -0.5) for equal steps, the ends of it (0.5, 0.5).
    """
    nodes = (np.asarray(times) - begin) / (end - begin)
    powers = np.arange(len(nodes))
    matrix = nodes[None, :] ** powers[:, None]
    weights: Values = np.linalg.solve(matrix, 1.0 / (powers + 1.0))
    return weights


def point_weights(times: Sequence[float], at: float, scale: float) -> Values:
    """Weights of values at `times` in the value at `at` of the polynomial through them."""
    nodes = (np.asarray(times) - at) / scale
    powers = np.arange(len(nodes))
    matrix = nodes[None, :] ** powers[:, None]
    weights: Values = np.linalg.solve(matrix, (powers == 0).astype(float))
    return weights


def combined(weights: Values, values: Sequence[Values]) -> Values:
    """Weighted sum of value arrays."""
    total: Values = weights[0] * values[0]
    for weight, one in zip(weights[1:], values[1:], strict=True):
        total = total + weight * one
    return total
