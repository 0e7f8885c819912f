"""Communication steps of a size that an error estimate finds, for a given tolerance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ..errors import Divergence, SimulationError
from .coupled_instance import Indices, Values
from .interrupt import Interrupt
from .masters import Master
from .masters.extrapolation import Past, combined, point_weights
from .observers import Watcher
from .stepper import Stepper
from .switch_location import SwitchLocation
from .system import System

LONGEST = 8.0
SHORTEST = 1e-5
"""Bounds of the step as multiples of the scenario's."""
MEMORY = 0.1
"""Cycles over which local errors are taken to add up, where there are cycles."""
LEAST_SHARE = 0.03
"""Share of the tolerance that any step may use up: numbers that are held miss by h, not by h^2."""
ORDER = 2.0
"""Order of the methods: with cycles the error per time is controlled, h^2, else the step's, h^3."""
MILNE = 1.0 / 6.0
"""Share of an extrapolation's miss that is counted as the step's own error."""


class Estimator(Protocol):
    """Takes one step and estimates its error."""

    rejects: bool

    def attempt(self, time: float, size: float) -> Values:
        """Step from `time`; return the estimated local error of each coupling value."""

    def undo(self) -> None:
        """Go back to before the last attempt; only where `rejects` is true."""

    def accept(self) -> None:
        """Keep the last attempt."""


class Doubling:
    """Takes a step whole and then in halves, from one saved state; the halves are kept."""

    rejects = True

    def __init__(self, stepper: Stepper, columns: Indices) -> None:
        self._stepper = stepper
        self._columns = columns
        self._moment = stepper.system.save()
        self._memory = stepper.master.remember()
        self.points: list[float] = []

    def attempt(self, time: float, size: float) -> Values:
        system, master = self._stepper.system, self._stepper.master
        half = 0.5 * size
        master.advance(time, size)
        whole = system.values[self._columns].copy()
        system.restore(self._moment)
        master.recall(self._memory)
        master.advance(time, half)
        master.advance(time + half, time + size - (time + half))
        self._stepper.steps += 3
        self.points = [time + half, time + size]
        return np.abs(whole - system.values[self._columns])

    @property
    def before(self) -> Values:
        """Values at the last point that was accepted."""
        return self._moment.values

    def undo(self) -> None:
        self._stepper.system.restore(self._moment)
        self._stepper.master.recall(self._memory)

    def accept(self) -> None:
        system = self._stepper.system
        system.forget(self._moment)
        self._moment = system.save()
        self._memory = self._stepper.master.remember()


class Foresight:
    """Compares a step with a parabola through the points before it; needs no rollback."""

    rejects = False

    def __init__(self, stepper: Stepper, columns: Indices) -> None:
        self._stepper = stepper
        self._columns = columns
        self._past = Past(3)
        self.points: list[float] = []

    def attempt(self, time: float, size: float) -> Values:
        values = self._stepper.system.values
        past, end = self._past, time + size
        past.note(time, values[self._columns])
        self._stepper.master.advance(time, size)
        self._stepper.steps += 1
        self.points = [end]
        foreseen = combined(point_weights(past.times, end, size), past.values)
        return MILNE * np.abs(foreseen - values[self._columns])

    def undo(self) -> None:
        raise NotImplementedError

    def accept(self) -> None:
        """Do nothing: no state is saved."""

    def interrupt(self) -> None:
        """Forget the points before a discontinuity: they predict nothing after it."""
        self._past.forget()


def adaptive(
    system: System,
    master: Master,
    tolerance: float,
    watching: Sequence[Watcher],
    interrupt: Interrupt | None = None,
) -> tuple[list[float], int, int]:
    """Step a system through its time span; communication points, steps, and rejections.

    The local error of a step, relative to the largest value seen, may use up its share of
    the tolerance: step over the time in which errors add up, `MEMORY` cycles. Where the scenario
    has no cycle it may use up all of it, as solvers of ODEs have it. A PI controller (Gustafsson
    1991) sets the next step; a step that misses by more is taken again, shorter, where all
    instances roll back. Steps end at discontinuities that are announced, and where all instances
    roll back, shortly after those that come as a switch on a wire: `switch_location`.
    """
    plan = system.plan
    grid = plan.grid
    stepper = Stepper(system, master)
    columns = coupling_columns(system)
    able = plan.rolls_back
    estimator = Doubling(stepper, columns) if able else Foresight(stepper, columns)
    control = Control(system, tolerance)
    location = SwitchLocation(system, columns, tolerance, control.least)
    scale = np.abs(system.values[columns])
    time, points, rejected = grid.start, [grid.start], 0
    size = grid.step if able else 0.1 * grid.step
    for observer in watching:
        observer.sample(system, 0, time)
    while time < grid.stop:
        end = _end(time, size, stepper.cut(time, grid.stop))
        event = system.next_event()
        try:
            error = estimator.attempt(time, end - time)
            np.maximum(scale, np.abs(system.values[columns]), out=scale)
            miss = float((error / (scale + 1e-300)).max(initial=0.0))
        except SimulationError:
            if not able or end - time <= control.least + 4.0 * math.ulp(end):
                raise
            miss = math.inf
        accepted, size = control.judge(miss, end - time, rejects=able)
        if accepted and isinstance(estimator, Doubling):
            if location.is_late(estimator.before, scale, end - time):
                accepted, size, location.latest = False, control.halved(end - time), end
            elif location.switched(estimator.before):
                location.latest = math.inf
                master.interrupt()
            else:
                size = location.next_size(size, end)
        if not accepted:
            estimator.undo()
            rejected += 1
            continue
        time = end
        points += estimator.points
        points[-1] = end
        stepper.arrive(end, event)
        if event <= end and isinstance(estimator, Foresight):
            estimator.interrupt()
            size = min(size, 0.1 * grid.step)
        estimator.accept()
        for observer in watching:
            observer.sample(system, len(points) - 1, end)
        if interrupt is not None:
            interrupt.check()
    return points, stepper.steps, rejected


def coupling_columns(system: System) -> Indices:
    """Places of the wired real values that are not members of laws."""
    plan = system.plan
    used = {f"{c.source}.{c.output.name}" for c in plan.connections if not c.output.order}
    chosen = [k for k in system.wired if system.names[k] in used and system.variables[k].real]
    return np.array(chosen, dtype=np.intp)


def _end(time: float, size: float, latest: float) -> float:
    """End of a step of about `size`; no tiny step is left over before `latest`."""
    left = latest - time
    if left <= 1.01 * size:
        return latest
    return time + (0.5 * left if left < 2.0 * size else size)


class Control:
    """PI control of the step size from the relative error of each step."""

    def __init__(self, system: System, tolerance: float) -> None:
        grid, frequency = system.plan.grid, system.plan.frequency
        span = grid.stop - grid.start
        self.span = min(span, MEMORY / frequency) if frequency else 0.0
        self.order = ORDER if frequency else ORDER + 1.0
        self.most = min(LONGEST * grid.step, span)
        if frequency:
            self.most = max(grid.step, min(self.most, 0.1 / frequency))
        self.least = SHORTEST * grid.step
        self.tolerance = tolerance
        self._before = 1.0

    def halved(self, size: float) -> float:
        """Half of a size that was rejected."""
        self._before = 1.0
        return max(self.least, 0.5 * size)

    def judge(self, miss: float, size: float, *, rejects: bool) -> tuple[bool, float]:
        """Whether a step is good enough, and the size of the next."""
        share = self.tolerance
        if self.span:
            share *= max(size / self.span, LEAST_SHARE)
        ratio = max(miss / share, 1e-6)
        if not math.isfinite(ratio):
            if not rejects:
                raise Divergence("a coupling value is no longer finite")
            return False, max(self.least, 0.2 * size)
        if rejects and ratio > 1.0 and size > self.least * (1.0 + 1e-6):
            self._before = 1.0
            return False, max(self.least, size * max(0.2, 0.9 * ratio ** (-1.0 / self.order)))
        factor = 0.9 * ratio ** (-0.7 / self.order) * self._before ** (0.4 / self.order)
        self._before = ratio
        return True, float(np.clip(size * min(4.0, max(0.2, factor)), self.least, self.most))
