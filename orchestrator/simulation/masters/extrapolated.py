"""Sequential master for instances without laws: plain numbers are extrapolated over the step."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ...scenario.schema import MasterSettings
from ..coupled_instance import CoupledInstance, Values
from ..system import System
from .base import Master
from .extrapolation import Past, combined, mean_weights, point_weights, tilt_weights

CONTROLLED_DEGREE = 3
"""Degree with a tolerance: a prey and predator of 1e-6 take a quarter of the steps of degree 1."""
RISING_DEGREE = 2
"""Degree where an instance lets its inputs rise: third order wants a parabola."""


class Extrapolated(Master):
    """Hold plain real numbers at the mean over the step of a polynomial of some degree.

    An instance takes one number for a whole step; the number that gives it the right impulse is
    the mean. From instances that have stepped already the value at the end is known, and the
    polynomial goes through it (degree 1: the mean of both ends); from the others it is
    extrapolated (degree 1: 1.5 u(n) - 0.5 u(n-1), the value at mid-step). Second order
    without rollback, at one step call per instance; a higher degree lowers the error, not the
    order, since within the step the instance still sees a constant. One that lets its inputs rise
    over a step is given the straight line with the mean and the first moment of the polynomial:
    third order by a parabola. Ports with laws are passed as they are. Where outputs follow inputs
    directly, the inputs are set to the end of the step before the outputs are read. After a
    discontinuity numbers are held until there are earlier points; inputs that rise go on by the
    rates of the outputs, where all instances give them.
    """

    options: ClassVar = ("degree",)

    def __init__(self, system: System, settings: MasterSettings) -> None:
        super().__init__(system, settings)
        controlled = system.plan.scenario.time.tolerance is not None
        self.rises = any(coupled.rising.any() for coupled in system.instances)
        usual = RISING_DEGREE if self.rises else 1
        self.degree = settings.degree or (CONTROLLED_DEGREE if controlled else usual)
        self._past = Past(self.degree + 1)

    def advance(self, time: float, size: float) -> None:
        system, past, end = self.system, self._past, time + size
        past.note(time, system.values)
        if self.rises and len(past.times) == 1:
            self._look_back(size)
        mean = combined(mean_weights(past.times, time, end), past.values)
        last = combined(point_weights(past.times, end, size), past.values)
        known = [end, *past.times][: self.degree + 1]
        weights = mean_weights(known, time, end)
        before = combined(weights[1:], past.values[: len(known) - 1])
        tilts = self._tilts(known, time, end) if self.rises else None
        stepped = np.zeros(len(system.values), dtype=bool)
        for coupled in system.instances:
            if len(coupled.plain):
                through = np.where(stepped, weights[0] * system.values + before, mean)
                finish = np.where(stepped, system.values, last)
                tilt = None
                if tilts is not None and coupled.rising.any():
                    foreseen, fixed, weight = tilts
                    tilt = np.where(stepped, weight * system.values + fixed, foreseen)
                self._step(coupled, through, tilt, finish, time, size)
            else:
                coupled.advance(time, size)
            stepped[coupled.stretch] = True
        system.follow()

    def _look_back(self, size: float) -> None:
        """Put a point before the only one, where all instances give the rates of their outputs."""
        rates = [coupled.instance.rates() for coupled in self.system.instances]
        known = [each for each in rates if each is not None]
        if len(known) < len(rates):
            return
        (time,), (values,) = self._past.times, self._past.values
        before = values.copy()
        for coupled, each in zip(self.system.instances, known, strict=True):
            before[coupled.stretch] -= size * each
        self._past.times, self._past.values = (time, time - size), (values, before)

    def _tilts(self, known: list[float], time: float, end: float) -> tuple[Values, Values, float]:
        """Half the rise of each value: as foreseen; of what has stepped, the part of earlier points
        and the weight of the value at the end."""
        past = self._past
        foreseen = combined(tilt_weights(past.times, time, end), past.values)
        weights = tilt_weights(known, time, end)
        fixed = combined(weights[1:], past.values[: len(known) - 1])
        return foreseen, fixed, weights[0]

    def _step(
        self,
        coupled: CoupledInstance,
        through: Values,
        tilt: Values | None,
        finish: Values,
        time: float,
        size: float,
    ) -> None:
        """Step one instance with the mean, or along the line, then read outputs that follow inputs
        with the end."""
        arriving = self.system.values[coupled.sources]
        places = coupled.sources[coupled.plain]
        arriving[coupled.plain] = through[places]
        if tilt is None:
            coupled.gather_from(arriving)
        else:
            rise = np.where(coupled.rising, tilt[places], 0.0)
            arriving[coupled.plain] -= rise
            coupled.gather_from(arriving)
            coupled.incline(2.0 * rise / size)
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
