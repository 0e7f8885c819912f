"""One run: a checked scenario stepped from start to stop, and what came of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..errors import ResilinError
from ..results.error_estimate import halved, with_estimates
from ..results.outcome import Outcome
from ..results.segments import Segments
from ..scenario.plan import Plan
from ..scenario.processes import is_guarded
from .guarded.kept import kept_between_runs
from .interrupt import Interrupt, Interrupted
from .observers import Observer, check_observers
from .rollback_probe import Spent, check_rollback
from .stepping import stepped
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
    with kept_between_runs():
        outcome = _stepped(
            plan,
            None,
            progress=progress,
            interrupt=interrupt,
            segments=segments,
            observers=observers,
        )
        if estimate is False or outcome.failure is not None:
            return outcome
        if estimate is not None or outcome.wall_time <= BUDGET:
            return estimated(outcome, interrupt=interrupt)
    took = f"the run took {outcome.wall_time:.0f} s, and its error is estimated unasked up to"
    return replace(outcome, doubt=f"{took} {BUDGET:g} s; ask with --estimate (estimate=True)")


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
        plan = replace(outcome.plan, texts=[])
        again = _stepped(plan, halved(outcome.points), interrupt=interrupt)
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
    """One run where its instances belong: in a process of their own, or in this one."""
    if is_guarded(plan) and not observers:
        from .guarded.run import run_guarded

        return run_guarded(plan, points, progress=progress, interrupt=interrupt, segments=segments)

    def here(*, probe: bool) -> Outcome:
        with System(plan) as system:
            if probe:
                check_rollback(system, points)
            return stepped(
                system,
                points,
                progress=progress,
                interrupt=interrupt,
                segments=segments,
                observers=observers,
            )

    try:
        return here(probe=True)
    except Spent:
        return here(probe=False)
