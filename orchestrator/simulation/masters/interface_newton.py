"""Interface-Newton master: solves the coupling's equations, with a Jacobian by differences."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ...errors import Divergence
from ...scenario.schema import MasterSettings
from ..coupled_instance import Indices, Values
from ..system import Moment, System
from .base import Master

NUDGE = 1e-6
SLOW = 0.2
"""A residual that falls by less than this factor asks for a fresh Jacobian."""


class InterfaceNewton(Master):
    """Solve z = G(z) for the wired values z at the end of a step, by quasi-Newton steps.

    G steps all instances from saved states with inputs made from z, plain real numbers as the
    mean of both ends of the step (the trapezoid rule, second order). Its Jacobian comes from
    nudging one input of one instance at a time; it is kept from step to step, improved by
    Broyden's updates, and made anew where the residual falls too slowly or the step changes.
    The run stays bounded where passes alone blow up (stiffness times step squared over mass far
    above one). Values that carry laws are taken as they come out. An instance that decides, that
    puts out nothing but switches, does so by the start of the step. Needs rollback in every
    instance.
    """

    needs_rollback: ClassVar = True
    options: ClassVar = ("settled", "passes")

    def __init__(self, system: System, settings: MasterSettings) -> None:
        super().__init__(system, settings)
        chosen = {int(k) for coupled in system.instances for k in coupled.sources[coupled.plain]}
        self._unknown: Indices = np.array(sorted(chosen), dtype=np.intp)
        self._scale = np.abs(system.values[system.wired])
        self._inverse: Values | None = None
        self._size = 0.0

    def interrupt(self) -> None:
        self._inverse = None

    def advance(self, time: float, size: float) -> None:
        system, unknown = self.system, self._unknown
        begin = system.values.copy()
        moment = system.save()
        if abs(size - self._size) > 1e-9 * size:
            self._inverse, self._size = None, size
        try:
            answer = self._pass(moment, begin, begin, time, size)
            trials = 0
            old = np.inf
            guess = begin
            while trials < self.settings.passes:
                residual = (answer - guess)[unknown]
                left = self._left(answer - guess)
                if left <= self.settings.settled:
                    system.values[:] = answer
                    system.follow()
                    return
                if not np.isfinite(left):
                    break
                if self._inverse is None or left > SLOW * old:
                    self._inverse = self._jacobian(moment, begin, guess, answer, time, size)
                    old = np.inf
                else:
                    old = left
                step = self._inverse @ residual
                following = answer.copy()
                following[unknown] = guess[unknown] + step
                answer = self._pass(moment, begin, following, time, size)
                self._improve(step, (answer - following)[unknown] - residual)
                guess = following
                trials += 1
        finally:
            system.forget(moment)
        wired = system.wired
        change = np.abs(answer - guess)[wired]
        worst = int(np.argmax(np.nan_to_num(change / (self._scale + 1e-300), nan=np.inf)))
        raise Divergence(
            f"{system.names[wired[worst]]} does not settle at t = {time:.9g} s: its residual is"
            f" {change[worst]:.2g} after {trials} Newton steps; lower the step"
        )

    def _left(self, change: Values) -> float:
        """Largest change of a wired value, relative to the largest that it has had."""
        wired = self.system.wired
        np.maximum(self._scale, np.abs(self.system.values[wired]), out=self._scale)
        return float((np.abs(change[wired]) / (self._scale + 1e-300)).max(initial=0.0))

    def _pass(
        self, moment: Moment, begin: Values, guess: Values, time: float, size: float
    ) -> Values:
        """G(guess): all instances stepped from the start of the step, side by side."""
        system = self.system
        system.restore(moment)
        for index in range(len(system.instances)):
            self._step(index, begin, guess, time, size)
        return system.values.copy()

    def _step(self, index: int, begin: Values, guess: Values, time: float, size: float) -> None:
        """Step one instance with inputs made from a guess of the end of the step."""
        coupled = self.system.instances[index]
        arriving = (begin if coupled.decides else guess)[coupled.sources]
        end = arriving.copy()
        places = coupled.sources[coupled.plain]
        arriving[coupled.plain] = 0.5 * (begin[places] + arriving[coupled.plain])
        coupled.gather_from(arriving)
        coupled.instance.step(time, size)
        if coupled.direct:
            coupled.gather_from(end)
        coupled.instance.receive()

    def _jacobian(
        self, moment: Moment, begin: Values, guess: Values, answer: Values, time: float, size: float
    ) -> Values:
        """Inverse of 1 - dG/dz, column by column; only instances that use a value are stepped."""
        system, unknown = self.system, self._unknown
        slope = np.zeros((len(unknown), len(unknown)))
        scale = dict(zip(system.wired.tolist(), self._scale.tolist(), strict=True))
        for column, place in enumerate(unknown.tolist()):
            nudge = NUDGE * max(scale[place], abs(float(guess[place])), 1e-6)
            moved = guess.copy()
            moved[place] += nudge
            system.values[:] = answer
            for index, coupled in enumerate(system.instances):
                if place in coupled.sources:
                    coupled.instance.restore(moment.states[index])
                    self._step(index, begin, moved, time, size)
            slope[:, column] = (system.values - answer)[unknown] / nudge
        try:
            inverse: Values = np.asarray(np.linalg.inv(np.eye(len(unknown)) - slope))
        except np.linalg.LinAlgError:
            raise Divergence(
                f"the coupling at t = {time:.9g} s has no unique solution: change the step"
            ) from None
        return inverse

    def _improve(self, step: Values, change: Values) -> None:
        """Broyden's update of the inverse, after which it maps -change to `step`."""
        if self._inverse is None:
            return
        gone = -(self._inverse @ change)
        weight = float(step @ gone)
        if abs(weight) > 1e-12 * float(step @ step):
            share = np.outer(step - gone, step @ self._inverse) / weight
            self._inverse = np.asarray(self._inverse + share, dtype=np.float64)
