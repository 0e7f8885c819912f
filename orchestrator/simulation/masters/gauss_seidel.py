"""Sequential master: each unit sees what the units before it have just computed."""

from __future__ import annotations

from .base import Master


class GaussSeidel(Master):
    """Step the units one after another, in the order of the plan.

    A unit that comes after the source of a law interpolates, since the law then holds at the
    end of its step; one that comes before extrapolates. The law carries its reference
    point, so the unit knows which. First order with held values; with affine laws second;
    with curvature the error falls further, up to fourth order where the source knows the
    mean of what it hands over. No rollback; one step call per unit.

    At the end the units whose outputs follow their inputs are read again with the inputs of
    the new communication point, so that what is recorded holds at its time label.
    """

    def advance(self, time: float, size: float) -> None:
        for coupled in self.system.instances:
            coupled.advance(time, size)
        self.system.follow()
