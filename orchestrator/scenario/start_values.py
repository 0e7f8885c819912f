"""Start values of a scenario, in the FMUs' units."""

from __future__ import annotations

from ..errors import Problems, nearest
from ..fmi.description import Interface, Variable
from ..units import UnitError, si_value
from .schema import Scenario


def starts_of(
    scenario: Scenario, interfaces: dict[str, Interface], problems: Problems
) -> dict[str, dict[str, float | str]]:
    """Start values in the FMUs' units, by component and variable."""
    starts: dict[str, dict[str, float | str]] = {}
    for name, component in scenario.components.items():
        settable = {v.name: v for v in interfaces[name].variables.values() if v.startable}
        starts[name] = {}
        for key, value in component.start.items():
            where = f"components.{name}.start.{key}"
            if key not in settable:
                known = interfaces[name].variables
                if key in known:
                    fault = f"{_kind(known[key])} cannot be set at the start"
                else:
                    fault = f"no parameter {key!r} in {name}; {nearest(key, settable)}"
                problems.add(where, fault)
                continue
            try:
                starts[name][key] = start_value(settable[key], value)
            except UnitError as error:
                problems.add(where, error)
    return starts


def _kind(variable: Variable) -> str:
    article = "an" if variable.causality[0] in "aeiou" else "a"
    return f"{article} {variable.causality} that is not of initial exact or approx"


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
