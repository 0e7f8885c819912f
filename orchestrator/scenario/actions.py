"""Timed actions of a scenario, in the FMUs' units."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import Problems, nearest, printable
from ..fmi.description import Interface, Variable
from ..units import UnitError
from .schema import Scenario
from .start_values import start_value
from .time_grid import seconds


@dataclass(frozen=True)
class Action:
    """Values that a component is given at a time [s]: tunable parameters or held inputs."""

    time: float
    component: str
    values: dict[str, float | str]


def actions_of(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    held: dict[str, float],
    frequency: float | None,
    problems: Problems,
) -> list[Action]:
    """Timed actions in the order of their times, one for each component that is touched."""
    actions = []
    for index, action in enumerate(scenario.actions):
        where = f"actions[{index}]"
        time = seconds(f"{where}.at", action.at, frequency, problems)
        if not action.set:
            problems.add(f"{where}.set", "is empty; name what is to change")
        touched: dict[str, dict[str, float | str]] = {}
        for name, value in action.set.items():
            component, _, rest = name.partition(".")
            try:
                variable = _settable(component, rest, interfaces, held)
                touched.setdefault(component, {})[rest] = start_value(variable, value)
            except UnitError as error:
                problems.add(f"{where}.set.{printable(name)}", error)
        actions += [Action(time, component, values) for component, values in touched.items()]
    return sorted(actions, key=lambda action: action.time)


def _settable(
    component: str, name: str, interfaces: dict[str, Interface], held: dict[str, float]
) -> Variable:
    """A variable that may be set while the scenario runs; `UnitError` says why it may not."""
    if component not in interfaces:
        raise UnitError(f"no component {printable(component)!r}; {nearest(component, interfaces)}")
    interface = interfaces[component]
    variable = interface.variables.get(name)
    may = [v.name for v in interface.of("parameter") if v.tunable]
    may += [key.partition(".")[2] for key in held if key.startswith(f"{component}.")]
    if variable is None:
        raise UnitError(f"no variable {printable(name)!r} in {component}; {nearest(name, may)}")
    if variable.causality == "input" and f"{component}.{name}" not in held:
        raise UnitError("is wired; an action sets tunable parameters and held inputs")
    if not variable.tunable or variable.causality not in {"input", "parameter"}:
        kind = f"{variable.variability} {variable.causality}"
        raise UnitError(f"is a {kind}, not to be changed in a run; {nearest(name, may)}")
    return variable
