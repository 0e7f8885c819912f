"""The compiled loop at work: it steps, and Python does what is rare.

Rare are: signals, the progress bar, room for rows, timed actions, and the words of an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from time import perf_counter
from typing import Any, NoReturn

from ...errors import Divergence
from ...fmi.instance import InProcessInstance
from ..energy_audit import Audit
from ..interrupt import Interrupt
from ..masters import Extrapolated, GaussSeidel, Jacobi, Master
from ..observers import Guard, Progress, Recorder, Watcher
from ..step_control import Control
from ..stepper import Stepper
from ..system import System
from . import structures as c
from .layout import Layout
from .library import library, missing

PATIENCE = 0.05
"""Seconds after which the loop lets Python look at signals and move the progress bar."""
WATCHED = (Guard, Recorder, Audit, Progress)


def unsuited(system: System, master: Master, watching: Sequence[Watcher]) -> str:
    """Why a run takes the Python loop; "" where the compiled one can take it."""
    if reason := missing():
        return reason
    if type(master) not in (GaussSeidel, Jacobi, Extrapolated):
        return f"{system.plan.scenario.master.kind} iterates, in Python"
    if system.plan.texts:
        return "texts are recorded in Python"
    if isinstance(master, Extrapolated) and master.rises:
        return "inputs rise over a step, in Python"
    if system.loop:
        return "an algebraic loop is solved after each step, in Python"
    strange = [type(o).__name__ for o in watching if type(o) not in WATCHED]
    return f"{strange[0]} observes in Python" if strange else ""


def drive(
    system: System,
    master: Master,
    watching: Sequence[Watcher],
    interrupt: Interrupt | None = None,
    points: Sequence[float] | None = None,
) -> int:
    """Step a system over its grid or over given points; number of steps taken.

    The same steps, rows and errors as :func:`orchestrator.simulation.stepping.advance` and `along`.
    """
    stepper = Stepper(system, master)
    start = system.plan.grid.start if points is None else points[0]
    for observer in watching:
        observer.sample(system, 0, start)
    return _Drive(system, master, stepper, watching, interrupt, points).to_the_end()


def drive_controlled(
    system: System,
    master: Master,
    tolerance: float,
    watching: Sequence[Watcher],
    interrupt: Interrupt | None = None,
) -> tuple[list[float], int, int]:
    """Step a system by a tolerance: communication points, steps, and rejections.

    The same as :func:`orchestrator.simulation.step_control.adaptive`.
    """
    stepper = Stepper(system, master)
    able = system.plan.rolls_back
    drive = _Drive(system, master, stepper, watching, interrupt, None)
    drive.control = drive.layout.control(system, master, Control(system, tolerance), able)
    for observer in watching:
        observer.sample(system, 0, system.plan.grid.start)
    drive.layout.guard.count = drive.guard.count
    drive.layout.point_recorder(drive.recorder)
    steps = drive.to_the_end()
    taken = drive.layout.taken[: drive.control.taken_count]
    return taken.tolist(), steps, int(drive.control.rejected)


def bare(system: System, master: Master, guard: Guard, recorder: Recorder) -> float:
    """Seconds that a step of the grid takes with nothing watched or recorded: for benchmarks."""
    drive = _Drive(system, master, Stepper(system, master), [guard, recorder], None, None)
    layout = drive.layout
    layout.guard.every = 0
    guard.high[:], guard.low[:] = inf, -inf
    layout.recorder.from_ = inf
    layout.run.patience = inf
    call, arguments = drive._call()
    begun = perf_counter()
    code = call(*arguments)
    if code != c.DONE:
        drive._stop(code)
    return (perf_counter() - begun) / float(layout.run.steps)


class _Drive:
    """One run of the loop: the structures, and the Python objects that they stand for."""

    def __init__(
        self,
        system: System,
        master: Master,
        stepper: Stepper,
        watching: Sequence[Watcher],
        interrupt: Interrupt | None,
        points: Sequence[float] | None,
    ) -> None:
        self.system = system
        self.stepper = stepper
        self.interrupt = interrupt
        by_kind = {type(observer): observer for observer in watching}
        guard, recorder = by_kind[Guard], by_kind[Recorder]
        assert isinstance(guard, Guard) and isinstance(recorder, Recorder)
        self.guard, self.recorder = guard, recorder
        audit, bar = by_kind.get(Audit), by_kind.get(Progress)
        self.audit = audit if isinstance(audit, Audit) else None
        self.bar = bar if isinstance(bar, Progress) else None
        self.layout = Layout(system, master, stepper, guard, recorder, self.audit, points)
        self.layout.run.patience = PATIENCE
        self.control: c.Control | None = None

    def to_the_end(self) -> int:
        """Call the loop until its last point, or raise what has stopped it."""
        call, arguments = self._call()
        run = self.layout.run
        while True:
            code = call(*arguments)
            self._take_back()
            if code == c.ACTION:
                self._act(run.end if run.within == 2 else run.time)
            elif code == c.FULL:
                self.recorder.make_room()
                self.layout.point_recorder(self.recorder)
                if self.control is not None:
                    self.layout.more_points(self.control)
            elif code not in (c.DONE, c.PAUSE):
                self._stop(code)
            else:
                self._look(run.index, run.end)
                if code == c.DONE:
                    return int(run.steps)

    def _call(self) -> tuple[Any, list[Any]]:
        """The loop's function and its arguments."""
        loop, layout = library(), self.layout
        assert loop is not None
        if self.control is None:
            return loop.resilin_run, layout.arguments(layout.audit)
        return loop.resilin_run_controlled, layout.arguments(self.control)

    def _take_back(self) -> None:
        """What the loop has counted, into the objects that report it."""
        self.stepper.steps = self.layout.run.steps
        self.recorder.count = self.layout.recorder.count
        for made, coupled in zip(self.layout.instances, self.system.instances, strict=True):
            if made.version:
                coupled.instance.steps = made.steps
                coupled.instance.rollbacks = made.rollbacks
                coupled.instance.warned = made.warned
        if self.audit is not None:
            for made, coupling in zip(self.layout.couplings, self.audit.couplings, strict=False):
                coupling.created, coupling.exchanged = made.created, made.exchanged

    def _act(self, time: float) -> None:
        self.stepper.act(time)
        self.layout.run.next_action = self.stepper.next_action
        self.layout.master.past.count = 0

    def _look(self, index: int, time: float) -> None:
        """Progress, late segments and signals, between two points."""
        if self.bar is not None:
            self.bar.sample(self.system, index, time)
        if self.recorder.write_if_late():
            self.layout.point_recorder(self.recorder)
        if self.interrupt is not None:
            self.interrupt.check()

    def _stop(self, code: int) -> NoReturn:
        """Raise what the Python loop raises at this place."""
        run = self.layout.run
        if code == c.OUT_OF_BOUNDS:
            self.guard.stop_out_of_bounds(self.system, run.end)
        if code == c.GROWTH:
            self.guard.stop_growth(self.system, run.end)
        if code == c.CREATED and self.audit is not None:
            self.audit.stop(self.audit.couplings[run.place], run.status, run.end)
        if self.layout.errors:
            raise self.layout.errors[0]
        if code == c.NOT_FINITE:
            raise Divergence("a coupling value is no longer finite")
        instance = self.system.instances[run.place].instance
        assert isinstance(instance, InProcessInstance)
        instance.explain(run.phase, run.status, run.time, run.size)
