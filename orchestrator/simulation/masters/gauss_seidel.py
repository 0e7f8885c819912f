"""Sequential master: each instance takes what the instances before it have just computed."""

from __future__ import annotations

from .base import Master


class GaussSeidel(Master):
    """Step the instances one after another, in the execution order of the plan.

    An instance that comes after the source of a law interpolates, since the law then holds at the
    end of its step; one that comes before extrapolates. The law carries its reference
    point, so the instance knows which. First order with held values; with affine laws second;
    with curvature the error falls further, up to fourth order where the source knows the
    mean of what it puts out. No rollback; one step call per instance.

    At the end the instances whose outputs follow their inputs are read again with the inputs of
    the new communication point, so that what is recorded holds at its time label.
    """

    def advance(self, time: float, size: float) -> None:
        for coupled in self.system.instances:
            coupled.advance(time, size)
        self.system.follow()
