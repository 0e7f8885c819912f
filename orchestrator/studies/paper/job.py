"""One run that a figure rests on: what is asked of a worker, and what it answers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...scenario.plan import Plan, fmu_path
from ..workers.task import RunFailed, answered

FORM = 1
"""Counts up when answers take another shape, so that older ones on disk are not taken for them."""

DIGITS = 9
"""Significant digits of a kept series: far below any error of a run, and half the disk."""


@dataclass(frozen=True)
class Job:
    """A scenario with changed start values and keys, run and looked at over its last `cycles`.

    `keep` are patterns of the recorded variables whose series come back; `cycles` 0 looks at the
    whole run. `per_cycle` is the number of steps in a cycle, `step` [s] takes
    its place in a scenario without cycles; None where the scenario's own is meant.

    With `inputs` nothing is run to an end: the scenario is linearised, seen once a cycle, from
    these held inputs to the variables that `keep` names. The rows of the answer are then `a`, `b`,
    `c`, `d`, row by row, and `rest`, the outputs about which it holds.
    """

    scenario: str
    changes: Mapping[str, str] = field(default_factory=dict)
    hold: Mapping[str, str] = field(default_factory=dict)
    record: tuple[str, ...] = ()
    keep: tuple[str, ...] = ()
    length: int | None = None
    per_cycle: int | None = None
    step: float | None = None
    cycles: int = 3
    inputs: tuple[str, ...] = ()

    def halved(self) -> Job | None:
        """The same at half the communication step; None where the scenario has to say it."""
        if self.per_cycle is not None:
            return replace(self, per_cycle=2 * self.per_cycle)
        return replace(self, step=0.5 * self.step) if self.step is not None else None

    def options(self) -> dict[str, Any]:
        """What the job overrides in its scenario."""
        time: dict[str, Any] = {}
        if self.length is not None:
            time["stop"] = f"{self.length} cycles"
        if self.per_cycle is not None:
            time["step"] = {"per_cycle": self.per_cycle}
        elif self.step is not None:
            time["step"] = self.step
        record = {"variables": list(self.record)} if self.record else {}
        return {"time": time, "hold": dict(self.hold), "record": record}


@dataclass(frozen=True)
class Answer:
    """What became of a job: `done`, or `failed` for a reason. `metrics` are those of a run."""

    status: str
    reason: str = ""
    metrics: Mapping[str, float] = field(default_factory=dict)
    times: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    rows: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    wall_time: float = 0.0
    steps: int = 0

    def series(self, ending: str) -> NDArray[np.float64]:
        """The kept series whose name ends so."""
        for name, values in self.rows.items():
            if name == ending or name.endswith(f".{ending}"):
                return values
        raise KeyError(ending)


def identity(job: Job, library: Path) -> str:
    """Digest of the resolved scenario, the FMU files, Resilin's version and what is looked at.

    The same conditions as those of a sweep's point, from the files alone: no FMU is opened.
    """
    from ...results.netcdf import release
    from ...scenario.parse import load_scenario

    scenario, path = load_scenario(job.scenario, dict(job.changes), **job.options())
    files = {
        name: _file(
            fmu_path(component.fmu, path, library)
            if component.fmu is not None
            else path.parent / str(component.data)
        )
        for name, component in scenario.components.items()
    }
    known = [
        *(FORM, release(), scenario.model_dump_json(by_alias=True), files),
        *(job.keep, job.cycles, job.inputs),
    ]
    return hashlib.sha256(json.dumps(known, sort_keys=True).encode()).hexdigest()[:32]


def carry_out(task: tuple[Job, str, str]) -> dict[str, Any]:
    """Run a job: the task of a worker. What goes wrong with the run is in the answer."""
    from ...simulation.guarded.kept import keep_between_runs
    from ...simulation.run import run

    keep_between_runs()
    job, library, _ = task

    def work() -> dict[str, Any]:
        if job.inputs:
            return _linearised(job, plan_of(job, Path(library)))
        outcome = run(plan_of(job, Path(library)), estimate=False)
        if outcome.failure is not None:
            raise RunFailed(str(outcome.failure))
        return _looked_at(job, outcome)

    return answered(work, {"metrics": {}, "times": [], "rows": {}})


def plan_of(job: Job, library: Path) -> Plan:
    """The checked plan of a job; `ScenarioError` with all that is wrong with it."""
    from ...simulation.load import load

    return load(job.scenario, dict(job.changes), library, **job.options())


def start_of(plan: Plan, key: str) -> float:
    """Start value [SI] of a scenario's `component.parameter`: the scenario's own, or the FMU's."""
    component, _, name = key.partition(".")
    known = plan.starts[component].get(name, plan.interfaces[component].variables[name].start)
    return float(known)  # type: ignore[arg-type]


def answer_of(content: Mapping[str, Any]) -> Answer:
    """The answer behind a worker's, or behind a file's JSON."""
    rows = {str(n): np.asarray(values, dtype=float) for n, values in content["rows"].items()}
    return Answer(
        status=str(content["status"]),
        reason=str(content["reason"]),
        metrics={str(name): float(value) for name, value in content["metrics"].items()},
        times=np.asarray(content["times"], dtype=float),
        rows=rows,
        wall_time=float(content["wall_time"]),
        steps=int(content["steps"]),
    )


def _looked_at(job: Job, outcome: Any) -> dict[str, Any]:
    from ...results.metrics import metrics

    plan = outcome.plan
    found = metrics(outcome, job.cycles or None)
    first = 0
    if job.cycles and plan.frequency:
        since = outcome.times[-1] - job.cycles / plan.frequency - 1e-9
        first = int(np.searchsorted(outcome.times, since))
    names = [n for n in outcome.names if any(n == p or fnmatchcase(n, p) for p in job.keep)]
    return {
        "metrics": {metric.name: metric.value for metric in found},
        "times": _short(outcome.times[first:]) if names else [],
        "rows": {name: _short(outcome.series(name)[first:]) for name in names},
        "steps": outcome.steps,
    }


def _linearised(job: Job, plan: Plan) -> dict[str, Any]:
    """The averaged model of a driven scenario: it is sampled once a cycle."""
    from ...simulation.linear.state_space import AVERAGED, MARKOV, linearise

    if plan.frequency is None:
        raise InputError(f"{plan.path}: is not linearised once a cycle: it has no frequency")
    found = linearise(
        plan, job.inputs, job.keep, count=MARKOV, interval=1.0 / plan.frequency, nudge=AVERAGED
    )
    named = {"a": found.a, "b": found.b, "c": found.c, "d": found.d, "rest": found.rest}
    rows = {name: [float(v) for v in values.ravel()] for name, values in named.items()}
    return {"metrics": {}, "times": [], "rows": rows, "steps": 0}


def _short(values: NDArray[np.float64]) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]


def _file(path: Path) -> str:
    """Digest of a file's content, read again when the file has changed."""
    try:
        state = path.stat()
        return _digest(path, state.st_mtime_ns, state.st_size)
    except OSError:
        return "missing"


@cache
def _digest(path: Path, changed: int, size: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
