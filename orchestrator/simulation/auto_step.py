"""The automatic step, where a scenario leaves it open: predicted stable, tried for accuracy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import floor

import numpy as np

from ..errors import InputError, InstanceFailure, ResilinError, ScenarioError
from ..results.error_estimate import estimate
from ..results.outcome import Outcome
from ..scenario.plan import Plan
from ..scenario.time_grid import Grid
from .interrupt import Interrupted
from .linear.drive import quiet
from .linear.step_map import MAPPED, SLACK, step_map
from .run import run

TARGET = 1e-3
"""Largest relative error of the leading variables that a step may have."""

SHARE = 1.0 / 3.0
"""Share of it that a trial may show: a trial is shorter than the run, and errors add up."""

CYCLES = 3
DOUBLINGS = 14
ALIKE = 3
"""Halvings in a row whose trials stop at the same time: then no step will do."""


@dataclass(frozen=True)
class AutomaticStep:
    """A step [s], its estimated error over a trial, and the spectral radius of its step map.

    `radius` is None for masters that have no map, and for instances that cannot roll back.
    """

    step: float
    error: float
    radius: float | None

    def __str__(self) -> str:
        stable = "" if self.radius is None else f", spectral radius {self.radius:.6f}"
        return f"step {self.step:.4g} s: estimated error {self.error:.1e} over a trial{stable}"


def automatic_step(plan: Plan) -> AutomaticStep:
    """The coarsest step, by halving from a tenth of a cycle, that is stable and accurate.

    Each is tried over the first cycles of the scenario, or over a tenth of its time span where
    there is no cycle, and never past its `stop`; the distance to the run at half the step estimates
    its error. Of an accurate one the linear step map, about rest with the drive off, predicts
    whether the coupling is stable.
    Raises `ScenarioError` where no step down to 1/163840 of a cycle will do, or where trials stop
    at one and the same time whatever the step, with the last reason.
    """
    if plan.fixed_step:
        fixed = ", ".join(plan.fixed_step)
        raise ScenarioError(
            f"{plan.path}: time.step: {fixed} can only take steps of one size; give that size"
        )
    step, reason, alike = plan.grid.step, "", 0
    coarse = _tried(plan, step)
    for _ in range(DOUBLINGS):
        fine = _tried(plan, 0.5 * step)
        failed = _failed(coarse), _failed(fine)
        if not any(failed) and isinstance(coarse, Outcome) and isinstance(fine, Outcome):
            error = _distance(plan, coarse, fine)
            radius = _radius(plan, step) if error <= SHARE * TARGET else None
            if error <= SHARE * TARGET and (radius is None or radius <= 1.0 + SLACK):
                return AutomaticStep(step, error, radius)
            reason = f"estimated error {error:.1e}" if radius is None else f"grows by {radius:.4f}"
        else:
            reason = str(failed[0] or failed[1])
            alike = (
                alike + 1 if _end(coarse) <= _end(fine) + step <= _end(coarse) + 2.0 * step else 0
            )
        step, coarse = 0.5 * step, fine
        if alike == ALIKE:
            break
    raise ScenarioError(f"{plan.path}: time.step: no step is found; at {step:.3g} s: {reason}")


def _failed(trial: Outcome | Exception) -> Exception | None:
    return trial.failure if isinstance(trial, Outcome) else trial


def _end(trial: Outcome | Exception) -> float:
    """Time [s] that a trial reached; minus infinity where it did not start."""
    return float(trial.times[-1]) if isinstance(trial, Outcome) and len(trial.times) else -np.inf


def _tried(plan: Plan, step: float) -> Outcome | Exception:
    """Outcome of the first cycles of a scenario at a step, or the error at its start."""
    grid = plan.grid
    span = CYCLES / plan.frequency if plan.frequency else 0.1 * (grid.stop - grid.start)
    stop = min(grid.stop, grid.start + span)
    count = max(1, floor((stop - grid.start) / step * (1.0 + 1e-9)))
    scenario = plan.scenario
    recorded = scenario.record.model_copy(update={"every": 1, "last": None})
    timed = scenario.time.model_copy(update={"tolerance": None})
    short = replace(
        plan,
        scenario=scenario.model_copy(update={"record": recorded, "time": timed}),
        grid=Grid(grid.start, min(grid.stop, grid.start + count * step), step, count),
        keep_from=-np.inf,
    )
    try:
        outcome = run(short, estimate=False)
    except ResilinError as error:
        return error
    if isinstance(outcome.failure, Interrupted):
        raise outcome.failure
    return outcome


def _distance(plan: Plan, coarse: Outcome, fine: Outcome) -> float:
    """Largest estimated relative error of the leading variables."""
    rows = fine.rows[::2]
    count = min(len(rows), len(coarse.rows))
    places = [coarse.names.index(name) for name in plan.leading]
    return max(
        (estimate(coarse.rows[:count, k], rows[:count, k]).relative for k in places), default=0.0
    )


def _radius(plan: Plan, step: float) -> float | None:
    """Spectral radius of the step map, where the master has one.

    A source that ends on the way to rest, after the run, is as little an answer.
    """
    kind = plan.scenario.master.kind
    if kind not in MAPPED:
        return None
    try:
        return step_map(quiet(plan), step).radius(kind)
    except InputError:
        return None
    except InstanceFailure as failure:
        sources = [name for name, known in plan.interfaces.items() if not known.of("input")]
        if not str(failure).startswith(tuple(f"{name}: " for name in sources)):
            raise
        return None
