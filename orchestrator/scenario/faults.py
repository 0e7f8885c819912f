"""Faults that a scenario injects into its components, to see how the others react."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ..errors import Problems, nearest, printable
from ..fmi.description import Interface, Variable
from ..units import UnitError, si_value
from .schema import Scenario
from .time_grid import seconds

SIZED = ("bias", "noise")


@dataclass(frozen=True)
class Fault:
    """What is wrong with a component from `begin` until `end` [s].

    `drop`: its step fails. The other kinds falsify its outputs in `variables` at communication
    points: `freeze` keeps the last value, `nan` gives NaN, `bias` adds `size`, `noise` adds a
    normal deviate of standard deviation `size` that `seed` and the time determine, the same
    however often a step is repeated.
    """

    begin: float
    end: float
    component: str
    kind: str
    variables: tuple[str, ...] = ()
    size: float = 0.0
    seed: int = 0


def faults_of(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    frequency: float | None,
    problems: Problems,
) -> list[Fault]:
    """Faults of a scenario in the FMUs' units."""
    found = []
    for index, fault in enumerate(scenario.faults):
        where = f"faults[{index}]"
        begin = seconds(f"{where}.at", fault.at, frequency, problems)
        end = inf
        if fault.until is not None:
            end = seconds(f"{where}.until", fault.until, frequency, problems)
        if not begin < end:
            problems.add(f"{where}.until", "has to be after at")
        component, _, name = fault.on.partition(".")
        try:
            variable = _output(component, name, fault.kind, interfaces)
        except UnitError as error:
            problems.add(f"{where}.on", error)
            continue
        try:
            size = _size(fault.kind, fault.size, variable)
        except UnitError as error:
            problems.add(f"{where}.size", error)
            continue
        names = (variable.name,) if variable else _numbers(interfaces[component])
        found.append(Fault(begin, end, component, fault.kind, names, size, fault.seed))
    return found


def _output(
    component: str, name: str, kind: str, interfaces: dict[str, Interface]
) -> Variable | None:
    """The output that a fault is on; None for the whole component."""
    if component not in interfaces:
        hint = nearest(component, interfaces)
        raise UnitError(f"no component {printable(component)!r}; {hint}")
    if not name:
        if kind in SIZED:
            raise UnitError(f"{kind} needs one output, as {component}.output")
        return None
    if kind == "drop":
        raise UnitError(f"a component drops out as a whole; write {component}")
    outputs = {v.name: v for v in interfaces[component].of("output") if v.real}
    if name not in outputs:
        hint = nearest(name, outputs)
        raise UnitError(f"no real output {printable(name)!r} in {component}; {hint}")
    return outputs[name]


def _size(kind: str, given: float | str | None, variable: Variable | None) -> float:
    if variable is None or kind not in SIZED:
        if given is not None:
            raise UnitError(f"means nothing to {kind}")
        return 0.0
    if given is None:
        raise UnitError(f"{kind} needs one, in {variable.unit or 'plain numbers'}")
    return si_value(given, variable.unit or "1")


def _numbers(interface: Interface) -> tuple[str, ...]:
    return tuple(v.name for v in interface.of("output") if v.real)
