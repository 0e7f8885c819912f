"""A list of cases: scenarios with something extreme about them, as checked data."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...errors import ScenarioError, nearest
from ...recording.settings import Quantity, Text
from ...scenario.files import read_toml
from ...scenario.parse import scenario_of
from ...scenario.plan import LIBRARY, Plan
from ...simulation.load import planned
from ..reference.solution import Reference

LADDER = (4, 8, 16, 32, 64, 128, 256, 512, 1024)
"""Communication steps in a cycle, unless a case has its own."""

SHIPPED = "cases/extremes.toml"


class Case(BaseModel):
    """A named scenario, given as a tree that may extend another, with start values changed.

    `per_cycle` are its steps; `reference` is what it is measured by where it is not the
    monolith, if there is one.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    name: Text
    title: Text = ""
    scenario: dict[str, Any]
    set: dict[str, Quantity | bool] = {}
    per_cycle: list[Annotated[int, Field(strict=True, ge=1, le=1_000_000)]] = list(LADDER)
    reference: Reference | None = None


class _List(BaseModel):
    """A file of cases."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    cases: list[Case]


def shipped() -> Path:
    """File of the cases that come with the package."""
    return Path(str(resources.files("scenarios") / SHIPPED))


def load_cases(path: Path, names: list[str] | None = None) -> list[Case]:
    """Cases of a TOML file, or those of them that are named; `ScenarioError` with what is wrong."""
    tree = read_toml(path)
    try:
        cases = _List.model_validate(tree).cases
    except ValidationError as error:
        raise ScenarioError(
            f"{path}: {'.'.join(map(str, e['loc']))}: {e['msg']}"
            for e in error.errors(include_url=False)
        ) from None
    known = [case.name for case in cases]
    if twice := {name for name in known if known.count(name) > 1}:
        raise ScenarioError(f"{path}: two cases are called {', '.join(sorted(twice))}")
    for name in names or []:
        if name not in known:
            raise ScenarioError(f"{path}: no case {name!r}; {nearest(name, known)}")
    return [case for case in cases if not names or case.name in names]


def plan_of(
    case: Case, path: Path, library: Path = LIBRARY, per_cycle: int | Literal["auto"] | None = None
) -> Plan:
    """Checked plan of a case of the file at `path`, at its scenario's own step or another."""
    time: dict[str, Any] = {}
    if per_cycle is not None:
        time["step"] = per_cycle if per_cycle == "auto" else {"per_cycle": per_cycle}
    tree = {"title": case.title, **case.scenario}
    scenario = scenario_of(tree, path, case.set, time=time)
    plan = planned(scenario, path, library)
    if plan.frequency is None:
        raise ScenarioError(f"{path}: {case.name}: steps in a cycle need time.frequency")
    return plan
