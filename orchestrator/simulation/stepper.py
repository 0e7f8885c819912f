"""From one communication point to the next, cut at discontinuities and timed actions."""

from __future__ import annotations

from math import inf

from .masters import Master
from .system import System

MERGED = 1e-6
"""Events closer than this fraction of a step to a communication point do not cut the step."""


class Stepper:
    """Steps a system with a master, never across a discontinuity or a timed action.

    Instances announce discontinuities through `next_event_time`. Where some instance takes steps of
    one size only nothing is cut: discontinuities are stepped over, and actions take effect
    at the next communication point. `steps` counts calls of the master.
    """

    def __init__(self, system: System, master: Master) -> None:
        self.system = system
        self.master = master
        self.steps = 0
        self.whole = bool(system.plan.fixed_step)
        self.margin = MERGED * system.plan.grid.step
        self._actions = list(system.plan.actions)
        self.quiet = not (system.announces or self._actions)
        self.act(system.plan.grid.start)

    @property
    def next_action(self) -> float:
        """Time of the next timed action; infinity without one."""
        return self._actions[0].time if self._actions else inf

    def act(self, time: float) -> None:
        """Carry out the actions that are due at a communication point."""
        while self._actions and self._actions[0].time <= time + self.margin:
            self.system.act(self._actions.pop(0))
            self.master.interrupt()

    def cut(self, time: float, end: float) -> float:
        """Latest end of a step from `time`: `end` if no event or action lies between."""
        if self.whole:
            return end
        stop = self.system.next_event()
        if self._actions:
            stop = min(stop, self._actions[0].time)
        return stop if time + self.margin < stop < end - self.margin else end

    def to(self, time: float, end: float, size: float) -> None:
        """Go from `time` to `end`, in one step of `size` where nothing lies between."""
        if self.quiet:
            self.master.advance(time, size)
            self.steps += 1
            return
        while True:
            stop = self.cut(time, end)
            if stop == end:
                break
            self.step(time, stop, stop - time)
            time, size = stop, end - stop
        self.step(time, end, size)

    def step(self, time: float, end: float, size: float) -> None:
        """One step of the master without events inside; then carry out what is due at its end."""
        event = self.system.next_event()
        self.master.advance(time, size)
        self.steps += 1
        self.arrive(end, event)

    def arrive(self, end: float, event: float) -> None:
        """Carry out what is due at a point that is kept; `event` is the last announced."""
        if event <= end + self.margin:
            self.master.interrupt()
        if self._actions:
            self.act(end)
