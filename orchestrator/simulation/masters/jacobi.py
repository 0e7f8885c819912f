"""Parallel master: every instance takes the outputs of all at the start of the step."""

from __future__ import annotations

from .base import Master


class Jacobi(Master):
    """Step all instances from the values of the last communication point.

    Laws are extrapolated over the step, so the error is larger than that of a sequential
    master by the ratio of extrapolation to interpolation; the order of the instances does not
    matter. First order with held values, second with laws. One step call per instance.
    """

    def advance(self, time: float, size: float) -> None:
        instances = self.system.instances
        for coupled in instances:
            coupled.gather()
        for coupled in instances:
            coupled.instance.step(time, size)
            coupled.instance.receive(0)
        self.system.follow()
