"""One run: a checked scene stepped from start to stop, and what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

from .errors import SceneError, SimulationError
from .interrupt import Interrupt, Interrupted
from .masters import Master, master
from .observers import Guard, Observer, Progress, Recorder
from .results import Outcome
from .scenario import load_scenario
from .system import System
from .wiring import LIBRARY, Plan, check

MERGED = 1e-6
"""An event closer than this fraction of a step to a communication point is not cut out."""


def load(
    scene: str | Path,
    changes: dict[str, str] | None = None,
    library: Path = LIBRARY,
    **options: Any,
) -> Plan:
    """Checked plan of a scene, by name or path, with `component.parameter` values changed."""
    scenario, path = load_scenario(scene, changes, **options)
    try:
        method = master(scenario.master.kind)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    plan = check(scenario, path, library)
    unable = [name for name, interface in plan.interfaces.items() if not interface.rollback]
    if method.needs_rollback and unable:
        raise SceneError(
            f"{path}: master.kind: {scenario.master.kind} needs rollback, which"
            f" {', '.join(unable)} cannot do; gauss-seidel works without it"
        )
    return plan


def run(plan: Plan, *, progress: bool = False, interrupt: Interrupt | None = None) -> Outcome:
    """Load the units of a plan, step them through its grid, and free them.

    A failure in mid-run does not raise: the outcome carries it beside what was recorded.
    """
    with System(plan) as system:
        method = master(plan.scenario.master.kind)
        recorder = Recorder(system, plan.scenario.record.every)
        bar = Progress(system) if progress else None
        watching: list[Observer] = [Guard(system), recorder]
        if bar is not None:
            watching.append(bar)
        failure: Exception | None = None
        begun = perf_counter()
        try:
            steps = advance(system, method, watching, interrupt)
        except (SimulationError, Interrupted) as error:
            failure = error
            steps = max((m.unit.steps for m in system.members), default=0)
        finally:
            if bar is not None:
                bar.close()
        wall_time = perf_counter() - begun
        calls = {m.unit.name: m.unit.steps for m in system.members}
    return Outcome(
        plan, recorder.names, recorder.times, recorder.rows, wall_time, steps, calls, failure
    )


def advance(
    system: System,
    method: Master,
    watching: Sequence[Observer],
    interrupt: Interrupt | None = None,
) -> int:
    """Step a system through its grid, cut at announced events; number of steps taken.

    Time is start + k * step. An event strictly between two points splits that step; rows
    are kept at the points of the grid alone, so that they stay equidistant.
    """
    grid = system.plan.grid
    step = grid.step
    margin = MERGED * step
    steps = 0
    for observer in watching:
        observer.sample(system, 0, grid.start)
    for k in range(grid.count):
        time = grid.point(k)
        end = grid.point(k + 1)
        event = system.next_event()
        while event < end - margin:
            if event > time + margin:
                method.advance(system, time, event - time)
                steps += 1
                time = event
            following = system.next_event()
            if following <= event:
                break
            event = following
        whole = time == grid.point(k) and k + 1 < grid.count
        method.advance(system, time, step if whole else end - time)
        steps += 1
        for observer in watching:
            observer.sample(system, k + 1, end)
        if interrupt is not None:
            interrupt.check()
    return steps
