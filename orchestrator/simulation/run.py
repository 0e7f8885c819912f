"""One run: a checked scenario stepped from start to stop, and what came of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from time import perf_counter
from typing import Any

from ..errors import OutputError, ResilinError, SimulationError
from ..results.error_estimate import halved, with_estimates
from ..results.outcome import Outcome, Report
from ..results.segments import Segments
from ..scenario.plan import Plan
from .compiled.drive import drive, drive_controlled, unsuited
from .energy_audit import Audit
from .interrupt import Interrupt, Interrupted
from .masters import Master, master_class
from .observers import (
    Guard,
    Observed,
    Observer,
    Progress,
    Recorder,
    Watcher,
    check_observers,
)
from .step_control import adaptive
from .stepper import Stepper
from .system import System

MOST_HELD = 1 << 25
"""Numbers of a run that an estimate holds in memory at most: 256 MB, and as much again."""
BUDGET = 10.0
"""Wall time of a run [s] up to which its error is estimated unasked, in twice that time."""


def run(
    plan: Plan,
    *,
    progress: bool = False,
    interrupt: Interrupt | None = None,
    segments: Segments | None = None,
    estimate: bool | None = None,
    observers: Sequence[Observer] = (),
) -> Outcome:
    """Load the instances of a plan, step them through its time span, and free them.

    Steps are those of the scenario's grid, or with a tolerance of the size that it asks for. The
    outcome carries estimated errors, see :func:`estimated`: of every run that takes up to `BUDGET`,
    of a longer one with `estimate=True`, of none with False.
    A failure in mid-run does not raise: the outcome carries it beside what was recorded, and its
    `checked` raises it.
    `segments` takes the rows of a long run off memory. `observers` are called at each
    communication point, see :class:`~orchestrator.simulation.observers.Observer`; one that raises
    ends the run as a failure in mid-run. Raises `InputError` where one has not their methods.
    """
    check_observers(observers)
    outcome = _stepped(
        plan, None, progress=progress, interrupt=interrupt, segments=segments, observers=observers
    )
    if estimate is False or outcome.failure is not None:
        return outcome
    if estimate is None and outcome.wall_time > BUDGET:
        took = f"the run took {outcome.wall_time:.0f} s, and its error is estimated unasked up to"
        return replace(outcome, doubt=f"{took} {BUDGET:g} s; ask with --estimate (estimate=True)")
    return estimated(outcome, interrupt=interrupt)


def replay(plan: Plan, points: Sequence[float], interrupt: Interrupt | None = None) -> Outcome:
    """Run a plan over given communication points instead of its own."""
    return _stepped(plan, points, interrupt=interrupt)


def estimated(outcome: Outcome, *, interrupt: Interrupt | None = None) -> Outcome:
    """The same outcome with errors of variables and metrics estimated, at twice the run's cost.

    The scenario is run again with half of each communication step, see
    :func:`orchestrator.results.error_estimate.with_estimates`. Where that run fails the outcome
    stays without estimates, and `doubt` is the reason.
    """
    if outcome.plan.fixed_step:
        fixed = ", ".join(outcome.plan.fixed_step)
        return replace(outcome, doubt=f"{fixed} can only take steps of one size")
    if outcome.kept * len(outcome.names) > MOST_HELD:
        return replace(outcome, doubt="the run is too long to be held in memory; see record.last")
    try:
        again = _stepped(outcome.plan, halved(outcome.points), interrupt=interrupt)
    except ResilinError as error:
        return replace(outcome, doubt=f"the second run, at half the step, fails: {error}")
    if isinstance(again.failure, Interrupted):
        return replace(outcome, failure=again.failure)
    if again.failure is not None:
        return replace(outcome, doubt=f"at half the step: {again.failure}")
    return with_estimates(outcome, again)


def _stepped(
    plan: Plan,
    points: Sequence[float] | None,
    *,
    progress: bool = False,
    interrupt: Interrupt | None = None,
    segments: Segments | None = None,
    observers: Sequence[Observer] = (),
) -> Outcome:
    with System(plan) as system:
        settings = plan.scenario.master
        tolerance = plan.scenario.time.tolerance
        master = master_class(settings.kind)(system, settings)
        recorder = Recorder(system, plan.scenario.record.every, segments)
        bar = Progress(system) if progress else None
        even = tolerance is None and points is None
        watching: list[Watcher] = [Guard(system, growth=even), recorder]
        audit = Audit(system)
        if even and audit.couplings:
            watching.append(audit)
        if observers:
            watching.append(Observed(system, observers))
        if bar is not None:
            watching.append(bar)
        reason = unsuited(system, master, watching)
        failure: Exception | None = None
        taken: Sequence[float] = []
        rejected = 0
        begun = perf_counter()
        try:
            looped = _in_python if reason else _in_c
            taken, steps, rejected = looped(system, master, watching, interrupt, points)
        except (SimulationError, OutputError, Interrupted) as error:
            failure = error
            steps = max((m.instance.steps for m in system.instances), default=0)
        finally:
            if bar is not None:
                bar.close()
        wall_time = perf_counter() - begun
        calls = {m.instance.name: m.instance.steps for m in system.instances}
        rollbacks = {m.instance.name: m.instance.rollbacks for m in system.instances}
        reports = {
            m.instance.name: Report(m.instance.messages, m.instance.warned, m.instance.warning)
            for m in system.instances
        }
    return Outcome(
        plan=plan,
        names=recorder.names,
        times=recorder.times,
        rows=recorder.rows,
        wall_time=wall_time,
        steps=steps,
        calls=calls,
        failure=failure,
        couplings=audit.summary(),
        points=taken,
        rejected=rejected,
        rollbacks=rollbacks,
        residual=system.residual,
        segments=segments,
        python_loop=reason,
        reports=reports,
    )


Stepped = tuple[Sequence[float], int, int]
"""Communication points, steps and rejections of a run."""


def _in_python(
    system: System,
    master: Master,
    watching: Sequence[Watcher],
    interrupt: Interrupt | None,
    points: Sequence[float] | None,
) -> Stepped:
    """Step over given points, the grid, or by the scenario's tolerance; the loop in Python."""
    tolerance = system.plan.scenario.time.tolerance
    if points is not None:
        return points, along(system, master, points, watching, interrupt), 0
    if tolerance is not None:
        return adaptive(system, master, tolerance, watching, interrupt)
    return _GridPoints(system.plan), advance(system, master, watching, interrupt), 0


def _in_c(
    system: System,
    master: Master,
    watching: Sequence[Watcher],
    interrupt: Interrupt | None,
    points: Sequence[float] | None,
) -> Stepped:
    """The same by the compiled loop."""
    tolerance = system.plan.scenario.time.tolerance
    if points is None and tolerance is not None:
        return drive_controlled(system, master, tolerance, watching, interrupt)
    taken = _GridPoints(system.plan) if points is None else points
    return taken, drive(system, master, watching, interrupt, points), 0


class _GridPoints(Sequence[float]):
    """Communication points of a grid, calculated on access."""

    def __init__(self, plan: Plan) -> None:
        self._grid = plan.grid

    def __len__(self) -> int:
        return self._grid.count + 1

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self._grid.point(k) for k in range(*index.indices(len(self)))]
        return self._grid.point(range(len(self))[index])


def advance(
    system: System,
    master: Master,
    watching: Sequence[Watcher],
    interrupt: Interrupt | None = None,
) -> int:
    """Step a system through its grid; number of steps taken.

    Time is start + k * step. A discontinuity or an action strictly between two points splits that
    step; rows are recorded at the points of the grid alone, so that they stay equidistant.
    """
    grid = system.plan.grid
    points = map(grid.point, range(grid.count + 1))
    spans = (
        (time, end, grid.step if k < grid.count else end - time)
        for k, (time, end) in enumerate(pairwise(points), start=1)
    )
    return _through(system, master, grid.start, spans, watching, interrupt)


def along(
    system: System,
    master: Master,
    points: Sequence[float],
    watching: Sequence[Watcher],
    interrupt: Interrupt | None = None,
) -> int:
    """Step a system over given communication points; number of steps taken."""
    spans = ((time, end, end - time) for time, end in pairwise(points))
    return _through(system, master, points[0], spans, watching, interrupt)


def _through(
    system: System,
    master: Master,
    start: float,
    spans: Iterable[tuple[float, float, float]],
    watching: Sequence[Watcher],
    interrupt: Interrupt | None,
) -> int:
    """Take steps, each from a time to an end by a size, watched at each end; their number."""
    stepper = Stepper(system, master)
    for observer in watching:
        observer.sample(system, 0, start)
    for k, (time, end, size) in enumerate(spans, start=1):
        stepper.to(time, end, size)
        for observer in watching:
            observer.sample(system, k, end)
        if interrupt is not None:
            interrupt.check()
    return stepper.steps
