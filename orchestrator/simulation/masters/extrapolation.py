"""Values at the last communication points, and weights of the polynomials through them."""

from __future__ import annotations

from collections.abc import Sequence

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


def mean_weights(times: Sequence[float], begin: float, end: float) -> list[float]:
    """Weights of values at `times` in the mean over [begin, end] of the polynomial through them.

    Two points before the interval give (1.5, -0.5) for equal steps, the ends of it (0.5, 0.5).
    Plain arithmetic in a fixed order: the compiled loop repeats it to the bit.
    """
    nodes = [(time - begin) / (end - begin) for time in times]
    return [_mean_of_basis(nodes, j) for j in range(len(nodes))]


def tilt_weights(times: Sequence[float], begin: float, end: float) -> list[float]:
    """Weights of values at `times` in half the rise over [begin, end] of the straight line that
    has the mean and the first moment of the polynomial through them.

    In s from 0 to 1 that line is mean + tilt (2 s - 1), tilt = 3 int y(s) (2 s - 1) ds.
    """
    nodes = [(time - begin) / (end - begin) for time in times]
    made = []
    for j in range(len(nodes)):
        coefficients, below = _basis(nodes, j)
        total = 0.0
        for k, coefficient in enumerate(coefficients):
            total = total + coefficient * (2.0 / float(k + 2) - 1.0 / float(k + 1))
        made.append(3.0 * total / below)
    return made


def _mean_of_basis(nodes: Sequence[float], j: int) -> float:
    """Integral over [0, 1] of the polynomial that is 1 at node `j` and 0 at the others."""
    coefficients, below = _basis(nodes, j)
    total = 0.0
    for k, coefficient in enumerate(coefficients):
        total = total + coefficient / float(k + 1)
    return total / below


def _basis(nodes: Sequence[float], j: int) -> tuple[list[float], float]:
    """Coefficients of the polynomial that vanishes at all nodes but `j`, and its value there."""
    coefficients, below = [1.0], 1.0
    for i, node in enumerate(nodes):
        if i == j:
            continue
        higher = [*coefficients, coefficients[-1]]
        for k in range(len(coefficients) - 1, 0, -1):
            higher[k] = coefficients[k - 1] - node * coefficients[k]
        higher[0] = -node * coefficients[0]
        coefficients = higher
        below = below * (nodes[j] - node)
    return coefficients, below


def point_weights(times: Sequence[float], at: float, scale: float) -> list[float]:
    """Weights of values at `times` in the value at `at` of the polynomial through them."""
    nodes = [(time - at) / scale for time in times]
    weights = []
    for j in range(len(nodes)):
        above, below = 1.0, 1.0
        for i, node in enumerate(nodes):
            if i != j:
                above = above * -node
                below = below * (nodes[j] - node)
        weights.append(above / below)
    return weights


def combined(weights: Sequence[float], values: Sequence[Values]) -> Values:
    """Weighted sum of value arrays."""
    total: Values = weights[0] * values[0]
    for weight, one in zip(weights[1:], values[1:], strict=True):
        total = total + weight * one
    return total
