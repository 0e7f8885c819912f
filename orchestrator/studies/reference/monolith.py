"""A scenario made of our parts as its own monolithic reference.

The part `monolith` composes the same physics as one ODE under the same names; with that part in
place of all others a scenario is its own reference.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ...errors import ScenarioError
from ...fmi.description import read_interface
from ...results.outcome import Outcome
from ...scenario.library import LIBRARY, PYTHON, folders, is_library, located, of_kind, part_names
from ...scenario.plan import Plan, check, fmu_path
from ...scenario.schema import Component, MasterSettings, Metrics, Record, Scenario

MONOLITH = "monolith"


def monolithic(plan: Plan, library: Path = LIBRARY) -> Plan:
    """Plan of the same scenario solved as one ODE.

    Raises `ScenarioError` where a component is not a part that the monolith is made of, where two
    components are the same part, or where an input is held at anything but zero: such a scenario
    needs another reference.
    """
    scenario = plan.scenario
    library = located(library, plan.path)
    home = _home(library)
    parts = {name: plan.interfaces[name].path.stem for name in plan.order}
    for name, part in parts.items():
        if plan.interfaces[name].path != fmu_path(part, plan.path, library):
            raise ScenarioError(f"{plan.path}: components.{name}: not a part of the monolith")
    probe = read_interface(fmu_path(MONOLITH, plan.path, home))
    known = {name.partition(".")[0] for name in probe.variables if "." in name}
    for name, part in parts.items():
        if part not in known:
            raise ScenarioError(f"{plan.path}: components.{name}: not a part of the monolith")
    if len(set(parts.values())) != len(parts):
        raise ScenarioError(
            f"{plan.path}: components: a scenario with two of one part has no monolith"
        )
    for key, value in plan.held.items():
        if value != 0.0:
            raise ScenarioError(f"{plan.path}: hold.{key}: the monolith holds it at zero")
    start = {
        f"{part}.{key}": value
        for name, part in parts.items()
        for key, value in scenario.components[name].start.items()
    }
    start["elasticity"] = "membrane" if "membrane" in parts.values() else "spring"
    start["mechanism"] = "linkage" if "linkage" in parts.values() else "payload"
    start["wings"] = "aero" if "aero" in parts.values() else "none"
    return _renamed(scenario, plan, start, home)


def _home(library: Path) -> Path:
    """Folder of the monolith; compiled parts take it from the sibling folder: it is of Python."""
    if is_library(library):
        return of_kind(library, PYTHON)
    if MONOLITH in part_names(library):
        return library
    siblings = [folder.with_name(PYTHON) for folder in folders(library)]
    return next((folder for folder in siblings if MONOLITH in part_names(folder)), library)


def _renamed(
    scenario: Scenario, plan: Plan, start: dict[str, float | str | bool], library: Path
) -> Plan:
    """Plan of the monolith that records what the scenario records."""
    parts = {name: plan.interfaces[name].path.stem for name in plan.order}
    records = [f"{MONOLITH}.{parts[c]}.{v.name}" for c, v in plan.records]
    single = scenario.model_copy(
        update={
            "components": {MONOLITH: Component(fmu=MONOLITH, start=start)},
            "wires": [],
            "hold": _held(MONOLITH),
            "record": Record(variables=records),
            "metrics": Metrics(cycles=scenario.metrics.cycles),
            "plot": {},
            "master": MasterSettings(),
            "time": scenario.time.model_copy(update={"frequency": plan.frequency}),
        }
    )
    return replace(check(single, plan.path, library), frequency=plan.frequency)


def _held(name: str) -> dict[str, float | str]:
    return {
        f"{name}.amplifier.command.top": 0.0,
        f"{name}.amplifier.command.bottom": 0.0,
    }


def as_recorded(reference: Outcome, plan: Plan) -> Outcome:
    """The monolith's outcome under the names of the scenario's components."""
    names = {plan.interfaces[name].path.stem: name for name in plan.order}
    renamed = []
    for name in reference.names:
        _, part, variable = name.split(".", 2)
        renamed.append(f"{names[part]}.{variable}")
    return replace(reference, names=renamed)
