"""Parallel master: every unit sees what all units put out at the start of the step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..system import System


@dataclass(frozen=True)
class Jacobi:
    """Step all units from the values of the last communication point.

    Laws are extrapolated over the step, so the error is larger than that of a sequential
    master by the ratio of extrapolation to interpolation; the order of the units does not
    matter. First order with held values, second with laws. One step call per unit.
    """

    needs_rollback: ClassVar[bool] = False

    def advance(self, system: System, time: float, size: float) -> None:
        for member in system.members:
            member.gather()
        for member in system.members:
            member.unit.step(time, size)
            member.unit.receive(0)
        for member in system.followers:
            member.follow()
