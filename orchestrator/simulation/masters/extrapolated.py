"""Sequential master for instances without laws: plain numbers are extrapolated over the step."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ...scenario.schema import MasterSettings
from ..coupled_instance import CoupledInstance, Values
from ..system import System
from .base import Master
from .extrapolation import Past, combined, mean_weights, point_weights

CONTROLLED_DEGREE = 3
"""Degree with a tolerance: a prey and predator of 1e-6 take a quarter of the steps of degree 1."""


class Extrapolated(Master):
    """Hold plain real numbers at the mean over the step of a polynomial of some degree.

    An instance takes one number for a whole step; the number that gives it the right impulse is
    the mean. From instances that have stepped already the value at the end is known, and the
    polynomial goes through it (degree 1: the mean of both ends); from the others it is
    extrapolated (degree 1: 1.5 u(n) - 0.5 u(n-1), the value at mid-step). Second order
    without rollback, at one step call per instance; a higher degree lowers the error, not the
    order, since within the step the instance still sees a constant. Ports with laws are passed as
    they are. Where outputs follow inputs directly, the inputs are set to the end of the step before
    the outputs are read. After a discontinuity numbers are held until there are earlier points.
    """

    options: ClassVar = ("degree",)

    def __init__(self, system: System, settings: MasterSettings) -> None:
        super().__init__(system, settings)
        controlled = system.plan.scenario.time.tolerance is not None
        self.degree = settings.degree or (CONTROLLED_DEGREE if controlled else 1)
        self._past = Past(self.degree + 1)

    def advance(self, time: float, size: float) -> None:
        system, past, end = self.system, self._past, time + size
        past.note(time, system.values)
        mean = combined(mean_weights(past.times, time, end), past.values)
        last = combined(point_weights(past.times, end, size), past.values)
        known = [end, *past.times][: self.degree + 1]
        weights = mean_weights(known, time, end)
        before = combined(weights[1:], past.values[: len(known) - 1])
        stepped = np.zeros(len(system.values), dtype=bool)
        for coupled in system.instances:
            if len(coupled.plain):
                through = np.where(stepped, weights[0] * system.values + before, mean)
                finish = np.where(stepped, system.values, last)
                self._step(coupled, through, finish, time, size)
            else:
                coupled.advance(time, size)
            stepped[coupled.stretch] = True
        system.follow()

    def _step(
        self, coupled: CoupledInstance, through: Values, finish: Values, time: float, size: float
    ) -> None:
        """Step one instance with the mean, then read outputs that follow inputs with the end."""
        arriving = self.system.values[coupled.sources]
        places = coupled.sources[coupled.plain]
        arriving[coupled.plain] = through[places]
        coupled.gather_from(arriving)
        coupled.instance.step(time, size)
        if coupled.direct:
            arriving[coupled.plain] = finish[places]
            coupled.gather_from(arriving)
        coupled.instance.receive(0)

    def interrupt(self) -> None:
        self._past.forget()

    def remember(self) -> Any:
        return self._past.times, self._past.values

    def recall(self, memory: Any) -> None:
        self._past.times, self._past.values = memory
