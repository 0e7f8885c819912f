"""A list of cases: scenarios with something extreme about them, as checked data."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from ...errors import ScenarioError
from ...recording.settings import Quantity, Text
from ...scenario.parse import scenario_of
from ...scenario.plan import LIBRARY, Plan
from ...simulation.load import planned
from ..named_list import Named, load_list
from ..reference.solution import Reference

PER_CYCLE = (4, 8, 16, 32, 64, 128, 256, 512, 1024)
"""Communication steps in a cycle, unless a case has its own."""

SHIPPED = "cases/extremes.toml"


class Case(Named):
    """A named scenario, given as a tree that may extend another, with start values changed.

    `per_cycle` are its steps in a cycle; `reference` chooses the reference solution, by default
    the monolith where there is one.
    """

    title: Text = ""
    scenario: dict[str, Any]
    set: dict[str, Quantity | bool] = {}
    per_cycle: list[Annotated[int, Field(strict=True, ge=1, le=1_000_000)]] = list(PER_CYCLE)
    reference: Reference | None = None


def shipped() -> Path:
    """File of the cases that come with the package."""
    return Path(str(resources.files("scenarios") / SHIPPED))


def load_cases(path: Path, names: list[str] | None = None) -> list[Case]:
    """Cases of a TOML file, all or those named; `ScenarioError` with what is wrong."""
    return load_list(path, "cases", Case, names)


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
