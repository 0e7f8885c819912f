"""Error against run time: one scenario by every method at a series of communication steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ResilinError
from ...scenario.library import LIBRARY
from ...scenario.patterns import matching
from ...scenario.plan import Plan
from ...simulation.guarded.kept import kept_between_runs
from ...simulation.interrupt import Interrupt, Interrupted
from ...simulation.load import load
from ...simulation.run import run
from ..reference.solution import Reference, ReferenceSolution, leading, reference_solution
from .method import Method, methods_for, own, parse_method, with_step

FACTORS = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125)
"""Steps as multiples of the scenario's own."""

TARGETS = (1e-2, 1e-3, 1e-4)
"""Errors for which the cheapest setting is looked up."""


@dataclass(frozen=True)
class MeasuredRun:
    """One run: its setting, its cost, and the error of each variable, or why it stopped.

    `status` is `done`, or `stopped: ` and the reason. `largest` and `rms` are errors relative to
    the reference's largest magnitude; `wall_time` is the least of the repeats, without loading.
    `order` is that of the largest error of the leading variables between this run and the coarser
    one before it, over the mean step where a tolerance chose the steps.
    """

    method: Method
    step: float
    tolerance: float | None
    status: str
    wall_time: float = float("nan")
    steps: int = 0
    calls: int = 0
    rollbacks: int = 0
    largest: dict[str, float] = field(default_factory=dict)
    rms: dict[str, float] = field(default_factory=dict)
    order: float = float("nan")


@dataclass(frozen=True)
class Study:
    """Runs of each method, against one reference whose own error is bounded."""

    title: str
    reference: str
    bound: dict[str, float]
    variables: list[str]
    frequency: float | None
    simulated: float
    runs: list[MeasuredRun]

    def error(self, measured: MeasuredRun) -> float:
        """Largest relative error of a run over the leading variables."""
        return max((measured.largest.get(name, np.nan) for name in self.variables), default=np.nan)

    def cheapest(self, target: float) -> MeasuredRun | None:
        """The run of the scenario itself with the least wall time that is within a target."""
        own = [r for r in self.runs if r.status == "done" and not r.method.scenario]
        good = [r for r in own if self.error(r) <= target]
        return min(good, key=lambda measured: measured.wall_time, default=None)


@kept_between_runs()
def precision(
    scenario: str | Path,
    library: Path = LIBRARY,
    *,
    methods: Sequence[Method | str] | None = None,
    factors: Sequence[float] = FACTORS,
    tolerances: Sequence[float] = (),
    also: Sequence[str | Path] = (),
    reference: Reference | None = None,
    variables: Sequence[str] | None = None,
    repeats: int = 3,
    changes: dict[str, str] | None = None,
    options: dict[str, Any] | None = None,
    interrupt: Interrupt | None = None,
    tell: Callable[[MeasuredRun], None] | None = None,
) -> Study:
    """Run a scenario by each method with its step times each of the `factors`.

    A method may be a text, as :func:`~orchestrator.studies.precision.method.parse_method` reads it.
    Besides, its own master gets each of the `tolerances`, and each scenario of `also`, by its own
    master, the same steps: a scenario with a part of another fidelity shows what that costs and
    how far it is from the first scenario. The reference is the first scenario's, see
    :func:`orchestrator.studies.reference.solution.reference_solution`.
    `variables`, by default the motion, lead: their errors give orders and the cheapest settings.
    Runs that fail stay in the study with their reason. Raises `InputError` on unknown variables and
    `ScenarioError` where the monolith is asked for and there is none.
    """
    named = [parse_method(m) if isinstance(m, str) else m for m in methods or ()]
    given = dict(options or {})
    plan = load(scenario, changes, library, **given)
    chosen = named or methods_for(plan)
    counting = matching(variables or [], plan.record_names, "--variable", "is not recorded")
    others = [load(other, None, library, **given) for other in also]
    solution = reference_solution(plan, library, reference, min(factors), interrupt)
    shown = leading(plan, solution.exact, counting)
    runs: list[MeasuredRun] = []
    bench = _Bench(solution, shown, repeats, interrupt, runs, tell or (lambda measured: None))
    steps = [factor * plan.grid.step for factor in sorted(factors, reverse=True)]
    for method in chosen:
        bench.measure(plan, method, [(step, None) for step in steps])
    for other in others:
        bench.measure(other, own(other, scenario=other.path.stem), [(step, None) for step in steps])
    if tolerances:
        sizes = sorted(tolerances, reverse=True)
        bench.measure(plan, own(plan, controlled=True), [(plan.grid.step, t) for t in sizes])
    simulated = plan.grid.stop - plan.grid.start
    return Study(
        title=plan.scenario.title,
        reference=solution.name,
        bound=solution.bound,
        variables=shown,
        frequency=plan.frequency,
        simulated=simulated,
        runs=runs,
    )


@dataclass(frozen=True)
class _Bench:
    """Measures methods one after another, all alike, and appends their runs to `runs`."""

    solution: ReferenceSolution
    leading: list[str]
    repeats: int
    interrupt: Interrupt | None
    runs: list[MeasuredRun]
    tell: Callable[[MeasuredRun], None]

    def measure(
        self, plan: Plan, method: Method, settings: Sequence[tuple[float, float | None]]
    ) -> None:
        """Measure one method at settings of step [s] and tolerance, coarsest first."""
        before: MeasuredRun | None = None
        for step, tolerance in settings:
            before = self._measured(plan, method, step, tolerance, before)
            self.runs.append(before)
            self.tell(before)

    def _measured(
        self,
        plan: Plan,
        method: Method,
        step: float,
        tolerance: float | None,
        before: MeasuredRun | None,
    ) -> MeasuredRun:
        """One setting, repeated; the reason is in its status where it does not run."""
        try:
            setting = with_step(plan, method, step, tolerance)
            done = run(setting, interrupt=self.interrupt, estimate=False)
            if isinstance(done.failure, Interrupted):
                raise done.failure
            if done.failure is not None:
                why = f"stopped: {done.failure}"
                return MeasuredRun(method, step, tolerance, why, steps=done.steps)
            wall = [
                run(setting, interrupt=self.interrupt, estimate=False).wall_time
                for _ in range(self.repeats)
            ]
        except ResilinError as error:
            return MeasuredRun(method, step, tolerance, f"stopped: {error}")
        largest, rms = self.solution.errors(done, self.interrupt)
        made = MeasuredRun(
            method=method,
            step=step,
            tolerance=tolerance,
            status="done",
            wall_time=min(wall),
            steps=done.steps,
            calls=sum(done.calls.values()),
            rollbacks=sum(done.rollbacks.values()),
            largest=largest,
            rms=rms,
        )
        return replace(made, order=self._order(before, made))

    def _order(self, before: MeasuredRun | None, measured: MeasuredRun) -> float:
        """Observed order between two runs; NaN where they cannot be compared."""
        if before is None or not before.largest or not self.leading:
            return float("nan")
        first = max(before.largest.get(name, 0.0) for name in self.leading)
        last = max(measured.largest.get(name, 0.0) for name in self.leading)
        finer = measured.steps / max(before.steps, 1)
        if not (first > 0.0 and last > 0.0 and finer > 1.0):
            return float("nan")
        return float(np.log(first / last) / np.log(finer))
