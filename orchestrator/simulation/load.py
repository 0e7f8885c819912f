"""A scenario by name or path as a checked plan that its master can step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import Problems, ScenarioError
from ..scenario.library import LIBRARY
from ..scenario.parse import load_scenario
from ..scenario.plan import Plan, check
from ..scenario.schema import AUTO, MasterSettings, Scenario
from ..scenario.settings import given
from .masters import master_class


def load(
    scenario: str | Path,
    changes: dict[str, str] | None = None,
    library: Path = LIBRARY,
    **options: Any,
) -> Plan:
    """Checked plan of a scenario, by name or path, with `component.parameter` values changed.

    `options` override single keys of a scenario's tables, as `time={"tolerance": 1e-3}`.
    Raises `ScenarioError` with every problem.
    """
    plan = planned(*load_scenario(scenario, changes, **options), library)
    return replace(plan, changes=given(changes, options))


def unloaded(
    scenario: str | Path,
    changes: dict[str, str] | None = None,
    library: Path = LIBRARY,
    **options: Any,
) -> Plan:
    """The same without loading any FMU: a step that trials are to find stays open.

    Its grid is then that of the first trial. Raises `ScenarioError` with every problem.
    """
    plan = check(*load_scenario(scenario, changes, **options), library)
    _unsuited(plan).check()
    return plan


def planned(scenario: Scenario, path: Path, library: Path = LIBRARY) -> Plan:
    """Checked plan of a scenario from a file at `path`, whose master is able to step it."""
    plan = check(scenario, path, library)
    searched = scenario.time.step == AUTO and scenario.time.tolerance is None
    if searched and not _unsuited(plan):
        from .auto_step import automatic_step

        found = automatic_step(plan)
        time = scenario.time.model_copy(update={"step": found.step})
        plan = check(scenario.model_copy(update={"time": time}), path, library)
        plan = replace(plan, step_reason=str(found))
    _unsuited(plan).check()
    return plan


def _unsuited(plan: Plan) -> Problems:
    """What the chosen master cannot do with these instances, and keys that it does not know."""
    settings = plan.scenario.master
    problems = Problems(plan.path)
    try:
        master = master_class(settings.kind)
    except ScenarioError as error:
        problems.add("master.kind", error)
        return problems
    unable = [name for name, interface in plan.interfaces.items() if not interface.rollback]
    if master.needs_rollback and unable:
        problems.add(
            "master.kind",
            f"{settings.kind} needs rollback, which {', '.join(unable)} cannot do;"
            " gauss-seidel and extrapolated work without it",
        )
    every = {key for key in MasterSettings.model_fields if key not in {"kind", "laws", "order"}}
    for key in sorted(settings.model_fields_set & every - set(master.options)):
        known = ", ".join(master.options) or "no further key"
        problems.add(f"master.{key}", f"means nothing to {settings.kind}, which takes {known}")
    return problems
