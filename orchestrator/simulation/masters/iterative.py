"""Iterative master: sequential passes over one step, with rollback, until they converge."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ...errors import Divergence
from ...scenario.schema import MasterSettings
from ..coupled_instance import Values
from ..system import System
from .acceleration import acceleration
from .base import Master


class Iterative(Master):
    """Repeat a sequential step from saved states until no wired output changes any more.

    In each pass every instance takes the end of the step from the last pass: laws hold at both
    ends of a loop, plain real numbers are the mean of both ends of the step (the trapezoid
    rule, second order). Passes converge where the coupling's gain over a step is below one, with
    `acceleration` beyond that; `Divergence` names the value that has not converged within `passes`.
    An instance that decides, that puts out nothing but switches, does so by the start of the step:
    by its end there may be no fixed point. Values have converged when they change by less than
    `settled` of the largest seen in the run. Needs rollback in every instance.
    """

    needs_rollback: ClassVar = True
    options: ClassVar = ("acceleration", "relaxation", "settled", "passes")

    def __init__(self, system: System, settings: MasterSettings) -> None:
        super().__init__(system, settings)
        self._scale = np.abs(system.values[system.wired])

    def advance(self, time: float, size: float) -> None:
        system, settings = self.system, self.settings
        wired = system.wired
        faster = acceleration(settings)
        begin = system.values.copy()
        moment = system.save()
        try:
            for index in range(settings.passes):
                guess = system.values[wired].copy()
                if index:
                    held = system.values.copy()
                    system.restore(moment)
                    system.values[:] = held
                self._pass(begin, time, size)
                answer = system.values[wired].copy()
                np.maximum(self._scale, np.abs(answer), out=self._scale)
                change = np.abs(answer - guess) / (self._scale + 1e-300)
                if index and float(change.max(initial=0.0)) <= settings.settled:
                    return
                if not np.all(np.isfinite(answer)):
                    break
                if index:
                    system.values[wired] = faster.next(guess, answer)
        finally:
            system.forget(moment)
        worst = int(np.argmax(np.nan_to_num(change, nan=np.inf)))
        raise Divergence(
            f"{system.names[wired[worst]]} does not settle at t = {time:.9g} s: it still changes"
            f" by {change[worst]:.2g} of its largest value after {settings.passes} passes; lower"
            " the step, set master.acceleration, or use interface-newton"
        )

    def _pass(self, begin: Values, time: float, size: float) -> None:
        """One sequential step with the best known values of its end."""
        system = self.system
        for coupled in system.instances:
            if coupled.decides:
                coupled.gather_from(begin[coupled.sources])
                coupled.instance.step(time, size)
                coupled.instance.receive(0)
                continue
            if not len(coupled.plain):
                coupled.advance(time, size)
                continue
            arriving = system.values[coupled.sources]
            places = coupled.sources[coupled.plain]
            arriving[coupled.plain] = 0.5 * (begin[places] + arriving[coupled.plain])
            coupled.gather_from(arriving)
            coupled.instance.step(time, size)
            if coupled.direct:
                coupled.gather()
            coupled.instance.receive(0)
        system.follow()
