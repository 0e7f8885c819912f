"""The reference solution of a scenario, and the errors of runs against it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...errors import ScenarioError, SimulationError
from ...results.outcome import Outcome
from ...scenario.patterns import matching
from ...scenario.plan import Plan
from ...simulation.interrupt import Interrupt
from ...simulation.run import replay, run
from ..precision.method import Method, own, with_step
from .monolith import as_recorded, monolithic

Reference = Literal["monolith", "self"]
AGREES = 0.05
"""Distance, by the largest value, up to which runs count as the same solution."""


@dataclass(frozen=True)
class ReferenceSolution:
    """A reference solution of a scenario; `bound` bounds its own error, where that is known.

    `single` is the scenario's monolith where there is one. It is solved again where a run
    communicates at other points; without it the solution is interpolated by cubic splines.
    """

    exact: Outcome
    name: str
    bound: dict[str, float] = field(default_factory=dict)
    single: Plan | None = None
    plan: Plan | None = None

    def errors(
        self, done: Outcome, interrupt: Interrupt | None = None
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Largest and root-mean-square error of each variable of a run.

        Relative to the reference's largest magnitude, over the times that both share.
        """
        exact = self.exact
        if done.plan.scenario.time.tolerance is not None:
            exact = self._at(done.points, interrupt)
        return errors(done, exact)

    def _at(self, points: Sequence[float], interrupt: Interrupt | None) -> Outcome:
        if self.single is not None and self.plan is not None:
            return as_recorded(_whole(replay(self.single, points, interrupt)), self.plan)
        from scipy.interpolate import CubicSpline

        times = np.asarray(points, dtype=float)
        return replace(
            self.exact, times=times, rows=CubicSpline(self.exact.times, self.exact.rows)(times)
        )


def errors(done: Outcome, exact: Outcome) -> tuple[dict[str, float], dict[str, float]]:
    """Largest and root-mean-square error of shared variables, relative to the second run's peak."""
    mine, theirs = common(done.times, exact.times)
    largest, rms = {}, {}
    for name in (name for name in exact.names if name in done.names):
        wanted = exact.series(name)
        off = done.series(name)[mine] - wanted[theirs]
        size = float(np.abs(wanted).max(initial=0.0)) or 1.0
        largest[name] = float(np.abs(off).max(initial=0.0)) / size
        rms[name] = float(np.sqrt(np.mean(off * off))) / size
    return largest, rms


def common(
    one: NDArray[np.float64], other: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Places of the times that two runs share, up to rounding."""
    grain = 1e-9 * max(float(one[-1] - one[0]), 1e-300)
    near = np.searchsorted(other, one - grain)
    near = np.minimum(near, len(other) - 1)
    same = np.abs(other[near] - one) <= grain
    return np.flatnonzero(same), near[same]


def reference_solution(
    plan: Plan,
    library: Path,
    wanted: Reference | None = None,
    finest: float = 1.0,
    interrupt: Interrupt | None = None,
) -> ReferenceSolution:
    """The monolith at the scenario's communication points; else a fine run of the scenario itself.

    That run is by the iterative master, or by Gauss-Seidel where iterations do not converge, at a
    quarter of the `finest` of the steps to be measured, which is given as a multiple of the
    scenario's; its error is bounded by the distance from the run at twice that step. Raises
    `ScenarioError` where a monolith is wanted and there is none, `SimulationError` where the
    reference itself cannot be calculated, or where it is none: the runs at both steps, or the run
    of the scenario's own master, disagree with it by more than `AGREES`.
    """
    if wanted != "self":
        try:
            single = monolithic(plan, library)
        except ScenarioError:
            if wanted == "monolith":
                raise
        else:
            points = [plan.grid.point(k) for k in range(plan.grid.count + 1)]
            exact = as_recorded(_whole(replay(single, points, interrupt)), plan)
            return ReferenceSolution(exact, "the monolith, DOP853 at 1e-10", {}, single, plan)
    able = plan.rolls_back
    try:
        return _itself(plan, "iterative" if able else "gauss-seidel", finest, interrupt)
    except SimulationError:
        if not able:
            raise
    return _itself(plan, "gauss-seidel", finest, interrupt)


def _itself(plan: Plan, kind: str, finest: float, interrupt: Interrupt | None) -> ReferenceSolution:
    """The scenario at a quarter of the finest step, bounded by the distance from that at half."""

    def ran(method: Method, share: float) -> Outcome:
        setting = with_step(plan, method, share * finest * plan.grid.step)
        return _whole(run(setting, interrupt=interrupt, estimate=False))

    method, usual = Method(kind, plan.scenario.master.laws), own(plan)
    finer = ran(method, 0.25)
    bound, _ = errors(ran(method, 0.5), finer)
    _agree(plan, bound, f"{method} at two steps")
    if usual != method:
        _agree(plan, errors(ran(usual, 0.25), finer)[0], f"{method} and {usual}")
    return ReferenceSolution(finer, f"itself by {method} at a quarter of the finest step", bound)


def _agree(plan: Plan, distance: dict[str, float], what: str) -> None:
    """`SimulationError` where runs that should be the same solution are not."""
    name, worst = max(
        ((n, distance[n]) for n in plan.leading if n in distance),
        key=lambda entry: entry[1],
        default=("", 0.0),
    )
    if not worst <= AGREES:
        raise SimulationError(
            f"{plan.path}: no reference: {what} disagree by {worst:.0%} on {name}; give a finer"
            " step"
        )


def _whole(outcome: Outcome) -> Outcome:
    if outcome.failure is not None:
        raise outcome.failure
    return outcome


def leading(plan: Plan, exact: Outcome, variables: Iterable[str] | None = None) -> list[str]:
    """Variables whose errors count: those named, else the leading ones of the scenario."""
    if variables:
        return matching([*variables], exact.names, "--variable", "is not recorded")
    return plan.leading
