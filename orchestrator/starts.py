"""Start values and timed actions of a scene, in the FMUs' units."""

from __future__ import annotations

from dataclasses import dataclass

from .errors import nearest, printable
from .grid import seconds
from .interface import Interface, Variable
from .scenario import Scenario
from .units import UnitError, si_value


@dataclass(frozen=True)
class Action:
    """Values that a unit is given at a time [s]: tunable parameters or held inputs."""

    time: float
    component: str
    values: dict[str, float | str]


def starts_of(
    scenario: Scenario, interfaces: dict[str, Interface], problems: list[str]
) -> dict[str, dict[str, float | str]]:
    """Start values in the FMUs' units, by component and variable."""
    starts: dict[str, dict[str, float | str]] = {}
    for name, component in scenario.components.items():
        settable = {v.name: v for v in interfaces[name].of("parameter", "input")}
        starts[name] = {}
        for key, value in component.start.items():
            where = f"components.{name}.start.{key}"
            if key not in settable:
                known = interfaces[name].variables
                hint = (
                    f"it is an {known[key].causality}" if key in known else nearest(key, settable)
                )
                problems.append(f"{where}: no parameter {key!r} in {name}; {hint}")
                continue
            try:
                starts[name][key] = start_value(settable[key], value)
            except UnitError as error:
                problems.append(f"{where}: {error}")
    return starts


def start_value(variable: Variable, value: float | str | bool) -> float | str:
    """One start value as the FMU takes it; `UnitError` where it does not fit."""
    if variable.kind == "String":
        return str(value)
    if variable.kind == "Boolean":
        if not isinstance(value, bool):
            raise UnitError(f"expected true or false, got {value!r}")
        return float(value)
    if variable.choices:
        if value not in variable.choices:
            raise UnitError(f"{value!r} is not a choice; {nearest(str(value), variable.choices)}")
        return float(variable.codes[variable.choices.index(str(value))])
    number = si_value(value, variable.unit or "1")
    span = variable.span()
    if span and not span[0] <= number <= span[1]:
        raise UnitError(f"{value!r} does not fit {variable.kind}, {span[0]:.0f} to {span[1]:.0f}")
    low, high = variable.least, variable.most
    if (low is not None and number < low) or (high is not None and number > high):
        bounds = f"{'-inf' if low is None else low} to {'inf' if high is None else high}"
        raise UnitError(f"{value!r} is outside {bounds} {variable.unit}")
    if span and not number.is_integer():
        raise UnitError(f"expected a whole number, got {value!r}")
    return number


def actions_of(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    held: dict[str, float],
    frequency: float | None,
    problems: list[str],
) -> list[Action]:
    """Timed actions in the order of their times, one for each unit that is touched."""
    actions = []
    for index, action in enumerate(scenario.actions):
        where = f"actions[{index}]"
        time = seconds(f"{where}.at", action.at, frequency, problems)
        if not action.set:
            problems.append(f"{where}.set: is empty; name what is to change")
        touched: dict[str, dict[str, float | str]] = {}
        for name, value in action.set.items():
            component, _, rest = name.partition(".")
            try:
                variable = _settable(component, rest, interfaces, held)
                touched.setdefault(component, {})[rest] = start_value(variable, value)
            except UnitError as error:
                problems.append(f"{where}.set.{printable(name)}: {error}")
        actions += [Action(time, component, values) for component, values in touched.items()]
    return sorted(actions, key=lambda action: action.time)


def _settable(
    component: str, name: str, interfaces: dict[str, Interface], held: dict[str, float]
) -> Variable:
    """A variable that may be set while the scene runs; `UnitError` says why it may not."""
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
