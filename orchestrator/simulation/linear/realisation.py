"""A linear system from its Markov parameters: eigensystem realisation, order and check."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
System = tuple[Values, Values, Values]
SMALLEST = 1e-9
"""Singular value, relative to the largest, below which there is only noise."""
TRIED = 6
"""Orders that are tried, those with the widest gap behind them first."""
GAP = 3.0
"""Ratio of neighbouring singular values from which on there is a gap between them."""


class Hankel:
    """The Hankel matrix of Markov parameters (count, outputs, inputs), decomposed once.

    Rows are scaled to like size here; the caller should scale columns by the usual size of each
    input, so that a weak response is not taken for noise, or noise for a response.
    """

    def __init__(self, sequence: Values) -> None:
        count, self._rows, self._columns = sequence.shape
        size = np.abs(sequence).max(axis=(0, 2), initial=0.0)
        self._size = np.where(size > 0.0, size, 1.0)
        scaled = sequence / self._size[None, :, None]
        half = count // 2
        blocks = [[scaled[i + j] for j in range(half)] for i in range(half)]
        after = [[scaled[i + j + 1] for j in range(half)] for i in range(half)]
        self._shifted = np.block(after)
        self._left, self.values, self._right = np.linalg.svd(np.block(blocks), full_matrices=False)

    def system(self, order: int) -> System:
        """A, B, C of some order whose Markov parameters C A^k B are nearest to the sequence.

        Juang and Pappa 1985: from the singular value decomposition U S V^T of the Hankel matrix,
        A = S^-1/2 U^T H' V S^-1/2 with the matrix H' one step later.
        """
        root = np.sqrt(self.values[:order])
        first, last = self._left[:, :order], self._right[:order]
        a = (first / root).T @ self._shifted @ (last.T / root)
        b = (root[:, None] * last)[:, : self._columns]
        c = (first * root)[: self._rows] * self._size[:, None]
        return np.asarray(a), np.asarray(b), np.asarray(c)

    def significant(self, smallest: float = SMALLEST) -> int:
        """Number of singular values above a share of the largest."""
        top = self.values[0] if len(self.values) else 0.0
        return int(np.sum(self.values > smallest * top)) if top > 0.0 else 0

    def orders(self) -> Iterator[int]:
        """Orders by the gap behind them, the widest first; then all that is above the noise."""
        most = self.significant()
        known = np.append(self.values[:most], SMALLEST * self.values[:1])
        gaps = known[:-1] / known[1:]
        wide = [int(k) + 1 for k in np.argsort(-gaps)[:TRIED] if gaps[k] > GAP]
        yield from dict.fromkeys([*wide, most])


def realise(sequence: Values, smallest: float = SMALLEST) -> System:
    """A, B, C whose Markov parameters C A^k B are a sequence (count, outputs, inputs).

    The order is the number of singular values of the Hankel matrix above `smallest` of the largest.
    """
    hankel = Hankel(sequence)
    return hankel.system(hankel.significant(smallest))


def held_response(system: System, direct: Values, count: int) -> Values:
    """Outputs (count, outputs, inputs) of a system at rest, each input one from step 0 on."""
    a, b, c = system
    state = np.zeros(b.shape)
    found = np.zeros((count, *direct.shape))
    for k in range(count):
        found[k] = c @ state + direct
        state = a @ state + b
    return found
