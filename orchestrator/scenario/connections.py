"""Wires of a scenario checked against the FMUs: ports, causality, types, units; held inputs."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ..errors import Problems, ScenarioError, nearest, printable
from ..fmi.description import Interface, Variable
from ..units import UnitError, factor
from .schema import Scenario, Wire
from .start_values import start_value

NO_FMU = 0
"""Version of FMI by which a recording is told from an FMU."""

LAW_ORDERS = {"held": 0, "affine": 1, "curvature": 2}


@dataclass(frozen=True)
class Connection:
    """One scalar that goes from an output to an input: target = gain * source + offset."""

    source: str
    output: Variable
    target: str
    input: Variable
    gain: float
    offset: float


def connections_of(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    fed: dict[str, str],
    problems: Problems,
) -> list[Connection]:
    """Scalar connections of all wires; `fed` notes what feeds each input."""
    most = LAW_ORDERS[scenario.master.laws]
    connections: list[Connection] = []
    for index, wire in enumerate(scenario.wires):
        where = f"wires[{index}] {printable(wire.source)} -> {printable(wire.target)}"
        try:
            pairs = _pairs(wire, interfaces)
            for source, output, target, input_ in pairs:
                scale = _scale(output, input_, wire)
                name = f"{target}.{input_.name}"
                if name in fed:
                    raise ScenarioError(f"{name} is fed twice, by {fed[name]} too")
                fed[name] = where
                _check_types(output, input_, wire)
                if input_.order > most or output.order > most:
                    continue
                connections.append(
                    Connection(source, output, target, input_, scale * wire.gain, wire.offset)
                )
        except (ScenarioError, UnitError) as error:
            problems.add(where, error)
            continue
    return connections


def _scale(output: Variable, target: Variable, wire: Wire) -> float:
    """Factor between the units of both ends; 1 where one end has none.

    Raises `ScenarioError` where a unit would be converted that its FMU does not define: the gain
    of the wire then has to say it.
    """
    if not (output.unit and target.unit) or output.unit == target.unit:
        return 1.0
    for variable in (output, target):
        if not variable.unit_defined:
            if "gain" in wire.model_fields_set:
                return 1.0
            raise ScenarioError(
                f"{output.name} is in {printable(output.unit)}, {target.name} in"
                f" {printable(target.unit)}, and the FMU does not define"
                f" {printable(variable.unit)}; give the wire a gain, gain = 1 to pass the number"
                " on as it is"
            )
    return factor(output.unit, target.unit)


def _check_types(output: Variable, target: Variable, wire: Wire) -> None:
    """`ScenarioError` where a value cannot pass from one type to the other without loss."""
    for variable in (output, target):
        if not variable.numeric:
            raise ScenarioError(f"{variable.name} is a {variable.kind}; only numbers can be wired")
    if target.real:
        return
    kinds = f"{output.name} is {output.kind}, {target.name} is {target.kind}"
    if wire.gain != 1.0 or wire.offset != 0.0:
        raise ScenarioError(f"{kinds}: gain and offset are for real numbers")
    if output.real:
        raise ScenarioError(f"{kinds}: a real number does not pass into it without loss")
    if target.kind == "Boolean" and output.kind != "Boolean":
        raise ScenarioError(f"{kinds}: only true and false pass into it")
    if target.kind == "Enumeration":
        alike = (output.choices, output.codes) == (target.choices, target.codes)
        if output.kind != "Enumeration" or not alike:
            raise ScenarioError(f"{kinds}: only the same choices pass into it")
        return
    into = target.span()
    low, high = _range(output)
    if into is not None and not (into[0] <= low and high <= into[1]):
        raise ScenarioError(f"{kinds}: {low:.0f} to {high:.0f} does not fit without loss")


def _range(variable: Variable) -> tuple[float, float]:
    """Least and greatest value that a variable of a whole type can have."""
    if variable.kind == "Boolean":
        return 0.0, 1.0
    if variable.codes:
        return float(min(variable.codes)), float(max(variable.codes))
    low, high = variable.span() or (-inf, inf)
    return (
        low if variable.least is None else max(low, variable.least),
        high if variable.most is None else min(high, variable.most),
    )


def _pairs(
    wire: Wire, interfaces: dict[str, Interface]
) -> list[tuple[str, Variable, str, Variable]]:
    """Outputs and inputs that a wire joins, as (component, output, component, input)."""
    source, outputs, whole = _end(wire.source, interfaces, "output")
    target, inputs, into_port = _end(wire.target, interfaces, "input")
    if not whole or not into_port:
        if len(outputs) > 1 and whole:
            outputs = outputs[:1]
        return [(source, outputs[0], target, inputs[0])]
    by_member = {v.member: v for v in inputs}
    pairs = [(source, o, target, by_member[o.member]) for o in outputs if o.member in by_member]
    if not pairs:
        raise ScenarioError(
            f"the ports share no member: {', '.join(v.member for v in outputs[:6])} against"
            f" {', '.join(v.member for v in inputs[:6])}"
        )
    if wire.gain != 1.0 or wire.offset != 0.0:
        raise ScenarioError("gain and offset are for single variables, not for whole ports")
    return pairs


def _end(
    text: str, interfaces: dict[str, Interface], causality: str
) -> tuple[str, list[Variable], bool]:
    """One end of a wire: component, variables, and whether it names a port."""
    component, _, rest = text.partition(".")
    if component not in interfaces:
        raise ScenarioError(
            f"no component {printable(component)!r}; {nearest(component, interfaces)}"
        )
    interface = interfaces[component]
    variable = interface.variables.get(rest)
    if variable is not None:
        if variable.causality != causality:
            raise ScenarioError(_wrong_causality(component, variable, causality))
        return component, [variable], False
    members = interface.port(rest, causality)
    if members:
        return component, members, True
    names = [v.name for v in interface.of(causality)] + interface.ports()
    remedy = ""
    if interface.version == NO_FMU and causality == "output":
        from ..recording.named_column import in_scenario

        remedy = f"; say which column it is, as {in_scenario(names, rest)}"
    raise ScenarioError(
        f"no {causality} {printable(rest)!r} in {component}; {nearest(rest, names)}{remedy}"
    )


def _wrong_causality(component: str, variable: Variable, causality: str) -> str:
    name = f"{component}.{variable.name}"
    if variable.causality == "parameter":
        return f"{name} is a parameter: set it under components.{component}.start"
    return f"{name} is an {variable.causality}, expected an {causality}"


def held_of(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    fed: dict[str, str],
    problems: Problems,
) -> dict[str, float]:
    """Held inputs and their values; an input that is wired too is a problem."""
    held: dict[str, float] = {}
    for name, value in scenario.hold.items():
        where = f"hold.{printable(name)}"
        try:
            _, variables, whole = _end(name, interfaces, "input")
            if whole:
                raise ScenarioError(f"is a port; hold its first member, {variables[0].name}")
            if name in fed:
                raise ScenarioError(f"is wired too, by {fed[name]}; remove one of the two")
            kept = start_value(variables[0], value)
            if isinstance(kept, str):
                raise ScenarioError("is a text; set it under components.*.start")
            held[name] = kept
        except (ScenarioError, UnitError) as error:
            problems.add(where, error)
            continue
        fed[name] = where
    return held


def check_all_fed(
    interfaces: dict[str, Interface], fed: dict[str, str], problems: Problems
) -> None:
    """Every input is wired or held; silence would be an assumption.

    A port whose first member is fed counts as fed: its other members keep their start
    values, which is a plain number in the place of a law. Texts keep theirs too.
    """
    for component, interface in interfaces.items():
        lacking: dict[str, Variable] = {}
        for variable in interface.of("input"):
            if not variable.numeric:
                continue
            first = interface.port(variable.port, "input")[0] if variable.port else variable
            if not fed.keys() & {f"{component}.{variable.name}", f"{component}.{first.name}"}:
                lacking.setdefault(first.name, first)
        for variable in lacking.values():
            name = f"{component}.{variable.name}"
            remedy = f'wire it, or hold: "{name}" = "0 {variable.unit}"'
            problems.add(name, f"neither wired nor held; {remedy}")
