"""A loaded system stepped from start to stop, observed, and what came of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import inf
from time import perf_counter
from typing import Any

from ..errors import OutputError, SimulationError
from ..results.outcome import Outcome, Report
from ..results.segments import Segments
from ..results.texts import Texts
from ..scenario.plan import Plan
from .compiled.drive import drive, drive_controlled, unsuited
from .energy_audit import Audit
from .interrupt import Interrupt, Interrupted
from .masters import Master, master_class
from .observers import Guard, Memory, Observed, Observer, Progress, Recorder, Sink, Watcher
from .step_control import adaptive
from .stepper import Stepper
from .system import System
from .text_recorder import TextRecorder


def stepped(
    system: System,
    points: Sequence[float] | None,
    *,
    progress: bool = False,
    interrupt: Interrupt | None = None,
    segments: Segments | Sink | None = None,
    observers: Sequence[Observer] = (),
    memory: Memory | None = None,
    texts: Texts | None = None,
) -> Outcome:
    """Step a system through its plan's time span, or over given points.

    `memory` is where rows go, by default arrays of this process, and `texts` where texts are noted.
    A failure in mid-run does not raise: the outcome carries it.
    """
    plan = system.plan
    settings = plan.scenario.master
    tolerance = plan.scenario.time.tolerance
    master = master_class(settings.kind)(system, settings)
    recorder = Recorder(system, plan.scenario.record.every, segments, memory)
    bar = Progress(plan) if progress else None
    even = tolerance is None and points is None
    watching: list[Watcher] = [Guard(system, growth=even)]
    if texts is None:
        texts = segments.texts if isinstance(segments, Segments) else Texts(plan.text_names)
    if plan.texts:
        watching.append(TextRecorder(system, plan.scenario.record.every, texts))
    watching.append(recorder)
    audit = Audit(system)
    if even and audit.couplings:
        watching.append(audit)
    if observers:
        watching.append(Observed(system, observers))
    if bar is not None:
        watching.append(bar)
    announced = system.next_event() < inf
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
    return Outcome(
        plan=plan,
        unseen=_stepped_over(plan) if announced else {},
        names=recorder.names,
        times=recorder.times,
        rows=recorder.rows,
        texts=texts.changes,
        wall_time=perf_counter() - begun,
        steps=steps,
        calls={m.instance.name: m.instance.steps for m in system.instances},
        failure=failure,
        couplings=audit.summary(),
        points=taken,
        rejected=rejected,
        rollbacks={m.instance.name: m.instance.rollbacks for m in system.instances},
        residual=system.residual,
        segments=segments if isinstance(segments, Segments) else None,
        python_loop=reason,
        reports={
            m.instance.name: Report(m.instance.messages, m.instance.warned, m.instance.warning)
            for m in system.instances
        },
    )


def _stepped_over(plan: Plan) -> dict[str, str]:
    """What is wrong with steps that cannot end at the discontinuities that are announced."""
    text = (
        "takes steps of one size, so no step ends at the discontinuities that are announced: they"
        " come late by up to a step"
    )
    return dict.fromkeys(plan.fixed_step, text)


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
    return GridPoints(system.plan), advance(system, master, watching, interrupt), 0


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
    taken = GridPoints(system.plan) if points is None else points
    return taken, drive(system, master, watching, interrupt, points), 0


class GridPoints(Sequence[float]):
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
