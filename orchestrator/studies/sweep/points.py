"""Points of a sweep: the tasks of workers, and their answers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from ...errors import ScenarioError
from ...scenario.plan import Plan
from ..workers.task import RunFailed, answered
from .axes import Axis

MOST_PROBLEMS = 20
CONDITIONS = ("scenario", "fmu_sha256", "resilin_version")


@dataclass(frozen=True)
class Setting:
    """What all points of a sweep share: the scenario and all but the axes' start values."""

    scenario: str
    library: str
    changes: Mapping[str, str]
    options: Mapping[str, Any]


@dataclass(frozen=True)
class Point:
    """One run of a sweep. `place` are its coordinates on the axes, in the FMUs' units.

    `key` digests the resolved scenario, the FMU files and Resilin's version: a result with the
    same key is the result of the same run.
    """

    setting: Setting
    values: tuple[str, ...]
    names: tuple[str, ...]
    key: str
    release: str
    place: tuple[float | str, ...]


@dataclass(frozen=True)
class Record:
    """The result of a point: `done` with its metrics (name, value, unit), or `failed`."""

    status: str
    reason: str = ""
    metrics: tuple[tuple[str, float, str], ...] = ()
    wall_time: float = 0.0
    steps: int = 0

    def metric(self, name: str) -> float | None:
        """Value of a metric; None where there is none of that name."""
        return next((value for known, value, _ in self.metrics if known == name), None)


@dataclass(frozen=True)
class Coordinate:
    """What a place on one axis means: name, unit, and whether it is a number."""

    name: str
    unit: str
    description: str
    numeric: bool
    whole: bool


@dataclass(frozen=True)
class Grid:
    """All points of the axes' product, checked; `plan` is that of the first one.

    `shape` counts the values on each axis; the last one changes first from point to point.
    """

    setting: Setting
    plan: Plan
    coordinates: list[Coordinate]
    shape: tuple[int, ...]
    points: list[Point]


def planned(setting: Setting, axes: Sequence[Axis], check: Callable[[], None]) -> Grid:
    """Load the plan of every point; `ScenarioError` with all their problems, each once."""
    problems: dict[str, None] = {}
    points: list[Point] = []
    first: Plan | None = None
    names = tuple(axis.name for axis in axes)
    for values in product(*(axis.values for axis in axes)):
        check()
        try:
            plan, point = point_at(setting, names, values)
        except ScenarioError as error:
            problems |= dict.fromkeys(error.problems)
            if len(problems) > MOST_PROBLEMS:
                raise ScenarioError([*list(problems)[:MOST_PROBLEMS], "... and more"]) from None
            continue
        first = first or plan
        points.append(point)
    if problems or first is None:
        raise ScenarioError(problems)
    coordinates = [_coordinate(first, name) for name in names]
    return Grid(setting, first, coordinates, tuple(len(axis.values) for axis in axes), points)


def point_at(
    setting: Setting, names: tuple[str, ...], values: tuple[str, ...]
) -> tuple[Plan, Point]:
    """Checked plan of one point, and the point."""
    plan = _plan(setting, dict(zip(names, values, strict=True)))
    key, release = _identity(plan)
    place = tuple(_place(plan, name, text) for name, text in zip(names, values, strict=True))
    return plan, Point(setting, values, names, key, release, place)


def _plan(setting: Setting, values: Mapping[str, str]) -> Plan:
    from ...simulation.load import load

    library = Path(setting.library)
    return load(setting.scenario, {**setting.changes, **values}, library, **setting.options)


def _identity(plan: Plan) -> tuple[str, str]:
    """Key of a plan, and the version of Resilin that is part of it."""
    from ...results.netcdf import provenance

    known = provenance(plan)
    text = json.dumps([known[condition] for condition in CONDITIONS])
    return hashlib.sha256(text.encode()).hexdigest()[:32], str(known["resilin_version"])


def _place(plan: Plan, name: str, text: str) -> float | str:
    """Start value of a parameter in its FMU's unit; a choice by its name."""
    component, _, parameter = name.partition(".")
    number = plan.starts[component][parameter]
    return text if _texts(plan, name) else number


def _texts(plan: Plan, name: str) -> bool:
    """Whether a parameter takes texts: a String, or a choice."""
    component, _, parameter = name.partition(".")
    variable = plan.interfaces[component].variables[parameter]
    return bool(variable.choices) or variable.kind in {"String", "Binary"}


def _coordinate(plan: Plan, name: str) -> Coordinate:
    component, _, parameter = name.partition(".")
    variable = plan.interfaces[component].variables[parameter]
    numeric = not _texts(plan, name)
    unit = (variable.unit or "1") if numeric else ""
    return Coordinate(name, unit, variable.description, numeric, variable.span() is not None)


def calculate(point: Point) -> dict[str, Any]:
    """Run one point: the task of a worker. The reason of a failure is in the answer.

    `unfit` in the answer is why the worker could not run this point: it lacks files, or has others
    than those that the sweep was planned with.
    """
    from ...simulation.guarded.kept import keep_between_runs

    keep_between_runs()
    return calculated(point)


def calculated(point: Point) -> dict[str, Any]:
    """The same in this process, which decides itself what it keeps between runs."""
    from ...results.metrics import metrics
    from ...simulation.run import run

    def work() -> dict[str, Any]:
        plan = _plan(point.setting, dict(zip(point.names, point.values, strict=True)))
        if unfit := _difference(point, plan):
            return {"unfit": unfit}
        outcome = run(plan, estimate=False)
        if outcome.failure is not None:
            raise RunFailed(str(outcome.failure), outcome.steps)
        found = metrics(outcome)
        return {
            "metrics": [[metric.name, metric.value, metric.unit] for metric in found],
            "steps": outcome.steps,
        }

    return answered(work, {"metrics": []})


def _difference(point: Point, plan: Plan) -> str:
    """How a worker's files differ from those that the point was planned with; empty if not."""
    key, release = _identity(plan)
    if release != point.release:
        return f"has resilin {release}, the sweep is of {point.release}; install the same"
    if key != point.key:
        return "has another scenario or other FMU files than the sweep was planned with"
    return ""
