"""The tasks of a stability study: the reference of a case, or its trials by one method."""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from ...errors import ResilinError, printable
from ...results.outcome import Outcome
from ...scenario.plan import Plan
from ...simulation.guarded.kept import keep_between_runs
from ...simulation.interrupt import Interrupt, Interrupted
from ...simulation.run import run
from ..precision.method import Method, own, with_step
from ..reference.solution import errors, leading, reference_solution
from .cases import Case, plan_of
from .classification import Trial, judged

LONGEST = 300
"""Characters of a reason, at most."""


@dataclass(frozen=True)
class Job:
    """A task: with a method the trials of a case, without one the case's reference."""

    case: Case
    file: Path
    library: Path
    folder: Path
    patience: float
    method: Method | None = None

    @property
    def solution(self) -> Path:
        """File of the reference."""
        return self.folder / f"{self.case.name}.npz"


class _Deadline(Interrupt):
    """Ends a run that takes too long."""

    def __init__(self, patience: float) -> None:
        super().__init__()
        self._end = monotonic() + patience

    def check(self) -> None:
        """Raise :class:`Interrupted` once time is up."""
        if monotonic() > self._end:
            raise Late(15)


class Late(Interrupted):
    """A run was not finished in time."""


def work(job: Job) -> dict[str, Any]:
    """Carry out a job in a worker; the reason of a failure is in the answer."""
    keep_between_runs()
    try:
        if job.method is None:
            return _reference(job)
        trials = [asdict(trial) for trial in _trials(job, job.method)]
        return {"trials": trials, "memory": _memory()}
    except ResilinError as error:
        return {"reason": _short(error)}


def _reference(job: Job) -> dict[str, Any]:
    """Solve a case at its finest steps, by its monolith or else by itself, into a file.

    Where neither has a solution the answer gives the reason: then every run of the case has to
    stop.
    """
    plan = plan_of(job.case, job.file, job.library, max(job.case.per_cycle))
    wanted: list[Any] = [job.case.reference] if job.case.reference else [None, "self"]
    reasons = []
    for kind in wanted:
        patience = _Deadline(4.0 * job.patience)
        try:
            found = reference_solution(plan, job.library, kind, interrupt=patience)
        except Late:
            reasons.append("it takes too long")
        except ResilinError as error:
            reasons.append(_short(error))
        else:
            exact, names = found.exact, leading(plan, found.exact)
            rows = exact.rows[:, [exact.names.index(name) for name in names]]
            np.savez(job.solution, times=exact.times, rows=rows, names=names)
            return {"reference": found.name, "bound": found.bound, "names": names}
    return {"reference": "", "reason": "; ".join(reasons)}


def _trials(job: Job, method: Method) -> list[Trial]:
    """Trials of one method, coarsest first; none is run that is finer than a late one."""
    own_plan = plan_of(job.case, job.file, job.library)
    exact = _solution(job, own_plan)
    usual = round(1.0 / (own_plan.frequency or 1.0) / own_plan.grid.step)
    trials: list[Trial] = []
    steps = sorted({*job.case.per_cycle, *([usual] if method == own(own_plan) else [])})
    for per_cycle in steps:
        marked = method == own(own_plan) and per_cycle == usual
        bare = Trial(job.case.name, method.kind, method.laws, per_cycle, "late", usual=marked)
        if trials and trials[-1].kind == "late":
            trials.append(replace(bare, reason="a coarser one was late"))
            continue
        plan = plan_of(job.case, job.file, job.library, per_cycle)
        trials.append(_trial(job, with_step(plan, method, plan.grid.step), exact, bare))
    if method == own(own_plan):
        trials.append(_automatic(job, method, exact))
    return trials


def _automatic(job: Job, method: Method, exact: Outcome | None) -> Trial:
    """The scenario's own master with the automatic step, or the reason why there is none."""
    bare = Trial(job.case.name, method.kind, method.laws, 0, "late", auto=True)
    try:
        plan = plan_of(job.case, job.file, job.library, "auto")
    except ResilinError as failure:
        return replace(bare, kind="stopped", reason=_short(failure))
    per_cycle = round(1.0 / (plan.frequency or 1.0) / plan.grid.step)
    bare = replace(bare, per_cycle=per_cycle)
    return _trial(job, with_step(plan, method, plan.grid.step), exact, bare)


def _trial(job: Job, plan: Plan, exact: Outcome | None, bare: Trial) -> Trial:
    """Run one setting and class the run."""
    try:
        done = run(plan, interrupt=_Deadline(job.patience), estimate=False)
        spent = replace(bare, wall_time=done.wall_time, calls=sum(done.calls.values()))
        if isinstance(done.failure, Interrupted):
            return replace(spent, kind="late", reason=f"more than {job.patience:g} s")
        if done.failure is not None:
            return replace(spent, kind="stopped", reason=_short(done.failure))
        if exact is None:
            return replace(spent, kind="unjudged", reason="the case has no reference solution")
        error = max(errors(done, exact)[0].values())
        kind, noticed_by = judged(done, error, exact.names)
    except ResilinError as failure:
        return replace(bare, kind="stopped", reason=_short(failure))
    return replace(spent, kind=kind, error=error, noticed_by=noticed_by)


def _solution(job: Job, plan: Plan) -> Outcome | None:
    """The reference of a case as an outcome of its leading variables; None without one."""
    if not job.solution.exists():
        return None
    kept = np.load(job.solution)
    names = [str(name) for name in kept["names"]]
    return Outcome(plan, names, kept["times"], kept["rows"], 0.0, 0, {})


def _memory() -> float:
    """Most memory [byte] that this process has used; 0 where the system does not report it."""
    try:
        import resource
    except ImportError:
        return 0.0
    grain = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * grain)


def _short(error: Exception) -> str:
    return printable(str(error).replace("\n", "; "), most=LONGEST)
