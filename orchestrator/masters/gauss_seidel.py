"""Sequential master: each unit sees what the units before it have just computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..system import System


@dataclass(frozen=True)
class GaussSeidel:
    """Step the units one after another, in the order of the plan.

    A unit that comes after the source of a law interpolates, since the law then holds at the
    end of its step; one that comes before extrapolates. The law carries its reference
    point, so the unit knows which. First order with held values; with affine laws second;
    with curvature the error falls further, up to fourth order where the source knows the
    mean of what it hands over. No rollback; one step call per unit.

    At the end the units whose outputs follow their inputs are read again with the inputs of
    the new communication point, so that what is recorded holds at its time label.
    """

    needs_rollback: ClassVar[bool] = False

    def advance(self, system: System, time: float, size: float) -> None:
        for member in system.members:
            member.advance(time, size)
        for member in system.followers:
            member.follow()
