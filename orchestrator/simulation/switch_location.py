"""When a Boolean or a choice on a wire changes: steps are halved until that is known well enough.

An instance that switches does so at the end of its step. A step in which it does is repeated,
shorter, until no wired value moves in it by more than the tolerance: the switch is then late by no
more than that, whatever the values do afterwards. Numbers that count are left alone, since each of
their steps would be halved.
"""

from __future__ import annotations

from math import inf

import numpy as np

from .coupled_instance import Indices, Values
from .system import System


def switch_columns(system: System) -> Indices:
    """Places of the wired values that switch."""
    chosen = [k for k in system.wired if system.variables[k].switches]
    return np.array(chosen, dtype=np.intp)


class SwitchLocation:
    """Judges steps that are good enough by their error; `latest` is the end of one with a switch.

    While it is finite the switch lies between the last communication point and `latest`.
    """

    def __init__(self, system: System, columns: Indices, tolerance: float, least: float) -> None:
        self._values = system.values
        self._columns = columns
        self._switches = switch_columns(system)
        self._tolerance = tolerance
        self._least = least
        self.latest = inf

    def switched(self, before: Values) -> bool:
        """Whether anything has switched since the values `before`."""
        there = self._switches
        return bool((self._values[there] != before[there]).any())

    def is_late(self, before: Values, scale: Values, size: float) -> bool:
        """Whether a step with a switch has moved too much, by the largest values seen."""
        if size <= self._least * (1.0 + 1e-6) or not self.switched(before):
            return False
        moved = np.abs(self._values[self._columns] - before[self._columns]) / (scale + 1e-300)
        return bool((moved > self._tolerance).any())

    def next_size(self, size: float, end: float) -> float:
        """Size of the step from `end`, so that it ends before a switch that is still to come."""
        left = self.latest - end
        if left <= self._least:
            self.latest = inf
            return size
        return min(size, max(self._least, 0.5 * left))
