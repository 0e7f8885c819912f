"""Start values of a scenario, in the FMUs' units."""

from __future__ import annotations

from collections.abc import Mapping

from ..errors import Problems, nearest, printable
from ..fmi.description import Interface, Variable
from ..units import UnitError, si_value
from .schema import Scenario

MOST_NAMED = 24
"""Parameters that a refusal lists: all of a usual part."""


def starts_of(
    scenario: Scenario, interfaces: dict[str, Interface], problems: Problems, dropped: list[str]
) -> dict[str, dict[str, float | str]]:
    """Start values in the FMUs' units, by component and variable.

    What does not fit is a problem. Start values that a base scenario has for another FMU in this
    place stay where all of them fit: then it is the same part built otherwise. Where one does not,
    it is another part, whose parameters of the same name mean something else: all of them are
    dropped, with a line in `dropped`.
    """
    starts: dict[str, dict[str, float | str]] = {}
    for name, component in scenario.components.items():
        interface, found = interfaces[name], dict[str, float | str]()
        wrong: dict[str, str | UnitError] = {}
        settable = {v.name: v for v in interface.variables.values() if v.startable}
        for key, value in component.start.items():
            if key not in settable:
                wrong[key] = f"{_unsettable(key, interface, settable, name)}"
                continue
            try:
                found[key] = start_value(settable[key], value)
            except UnitError as error:
                wrong[key] = error
        for key, fault in wrong.items():
            if key not in component.inherited:
                problems.add(f"components.{name}.start.{key}", fault)
        if wrong.keys() & set(component.inherited):
            found = {key: v for key, v in found.items() if key not in component.inherited}
            listed = ", ".join(component.inherited)
            dropped.append(
                f"{name} starts afresh: {component.fmu} has other parameters than the base"
                f" scenario gives ({listed})"
            )
        starts[name] = found
    return starts


def without_misfits(
    scenario: Scenario, starts: Mapping[str, Mapping[str, float | str]]
) -> Scenario:
    """The scenario with only those inherited start values that are among `starts`."""
    components = dict(scenario.components)
    for name, component in components.items():
        if component.inherited:
            kept = {key: value for key, value in component.start.items() if key in starts[name]}
            components[name] = component.model_copy(update={"start": kept, "inherited": []})
    return scenario.model_copy(update={"components": components})


def _unsettable(
    key: str, interface: Interface, settable: Mapping[str, Variable], component: str
) -> str:
    """Why a name is nothing that can be set at the start, with the nearest that is."""
    known = interface.variables.get(key)
    if known is None:
        members = {name for name, v in settable.items() if v.causality != "parameter"}
        hint = nearest(key, settable.keys() - members, later=members, show=MOST_NAMED)
        return f"no parameter {printable(key)!r} in {component}; {hint}"
    article = "an" if known.causality[0] in "aeiou" else "a"
    return (
        f"{article} {known.causality} that is not of initial exact or approx cannot be set at the"
        " start"
    )


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
