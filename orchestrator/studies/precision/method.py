"""A method to step a scenario: a master, and how much of each port is used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...errors import InputError, nearest
from ...scenario.plan import Plan, check
from ...scenario.schema import Scenario
from ...simulation.masters import MASTERS

LAWS = ("held", "affine", "curvature")


@dataclass(frozen=True)
class Method:
    """A master, and how much of each port is used.

    With `controlled` a tolerance chooses the steps; `scenario` names another scenario that is
    stepped in place of the studied one, for parts of another fidelity.
    """

    kind: str
    laws: str
    controlled: bool = False
    scenario: str = ""

    def __str__(self) -> str:
        label = f"{self.kind}, {self.laws}" + (", by tolerance" if self.controlled else "")
        return f"{self.scenario}: {label}" if self.scenario else label


def parse_method(text: str) -> Method:
    """A method from a text as `gauss-seidel` or `jacobi/held`; `InputError` where there is none."""
    kind, _, laws = text.partition("/")
    if kind not in MASTERS:
        raise InputError(f"--method {text!r}: no master {kind!r}; {nearest(kind, MASTERS)}")
    if laws and laws not in LAWS:
        raise InputError(f"--method {text!r}: no such use of laws; {nearest(laws, LAWS)}")
    return Method(kind, laws or "curvature")


def methods_for(plan: Plan) -> list[Method]:
    """Every master that the instances allow; with laws where the scenario has any, and without."""
    able = plan.rolls_back
    lawful = _lawful(plan)
    kinds = [name for name, master in MASTERS.items() if able or not master.needs_rollback]
    used = [("curvature" if lawful else "held"), *(["held"] if lawful else [])]
    return [Method(kind, laws) for laws in used for kind in kinds]


def own(plan: Plan, *, controlled: bool = False, scenario: str = "") -> Method:
    """The method that the scenario itself asks for; without laws it is one of held numbers."""
    settings = plan.scenario.master
    laws = settings.laws if _lawful(plan) else "held"
    return Method(settings.kind, laws, controlled, scenario)


def _lawful(plan: Plan) -> bool:
    """Whether any port passes a law."""
    return any(c.input.order for c in plan.connections)


def with_step(plan: Plan, method: Method, step: float, tolerance: float | None = None) -> Plan:
    """The same scenario with another method and another step, every point recorded."""
    scenario = plan.scenario
    time = {"start": plan.grid.start, "stop": plan.grid.stop, "step": step, "tolerance": tolerance}
    time["frequency"] = plan.frequency
    changed = {
        "time": time,
        "master": {"kind": method.kind, "laws": method.laws, "order": plan.order},
        "record": {**scenario.record.model_dump(), "every": 1},
    }
    merged = {**scenario.model_dump(by_alias=True), **changed}
    return load_tree(merged, plan)


def load_tree(tree: dict[str, Any], plan: Plan) -> Plan:
    """A changed scenario checked against the same FMUs."""
    paths = {name: str(known.path.resolve()) for name, known in plan.interfaces.items()}
    for name, component in tree["components"].items():
        component["fmu" if component["data"] is None else "data"] = paths[name]
    return check(Scenario.model_validate(tree), plan.path)
