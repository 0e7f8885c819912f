"""What sample.py imports: names that clash with its own, and with words of C."""

from __future__ import annotations

import math
from dataclasses import dataclass

SCALE = 3.0
"""Its own, though the sample has another one."""

SHARED = ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))


@dataclass(frozen=True)
class Pose:
    """Another Pose than the sample's."""

    far: float


def scaled(x: float, by: float = 2.0, shift: float = 0.5) -> float:
    """A function with defaults; /* and what */ would end a comment."""
    return x * by + shift * SCALE


def free(x: float) -> float:
    """Named as a function of the C library."""
    return math.sqrt(x) - 1.0


def chosen(x: float) -> float:
    """A name that the sample has too."""
    return SHARED[1][0] * x


def posed(x: float) -> Pose:
    return Pose(far=-x)
