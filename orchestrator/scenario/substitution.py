"""A recording in the place of a part: the scenario drops what a recording does not have.

A scenario that extends another may put a recording in the place of one part and leave all else
as it is. What the part has and the recording does not have is dropped and listed: wires into it,
holds and actions on it, and records of outputs that are not among its columns. A wire from a
port that was not recorded gives way to a hold of the input that it feeds; without such a hold it
is a problem, and so is a port whose first member was not recorded.

Where another FMU takes the place of a part, wires and holds have to fit; records and metrics that
were inherited for the old part are dropped and listed.
"""

from __future__ import annotations

from collections.abc import Collection
from fnmatch import fnmatchcase

from ..errors import Problems, nearest, printable
from ..fmi.description import Interface
from .metric_expression import expression_of
from .schema import ActionSpec, Metrics, Record, Scenario, Wire


def substituted(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    recorded: Collection[str],
    problems: Problems,
) -> tuple[Scenario, list[str]]:
    """The scenario without what its recordings do not have, and a line for all that was dropped."""
    if not recorded and not scenario.of_replaced:
        return scenario, []
    dropped: list[str] = []
    wires = [
        wire
        for wire in scenario.wires
        if not _drops_wire(wire, scenario, interfaces, recorded, dropped, problems)
    ]
    hold = {}
    for name, value in scenario.hold.items():
        if name.partition(".")[0] in recorded:
            dropped.append(f"hold {name}: a recording has no inputs")
        else:
            hold[name] = value
    actions = [_kept(action, recorded, dropped) for action in scenario.actions]
    left = {
        "wires": wires,
        "hold": hold,
        "actions": [a for a in actions if a.set],
        "record": _records(scenario, interfaces, recorded, dropped),
        "metrics": _metrics(scenario, interfaces, recorded, dropped),
    }
    return scenario.model_copy(update=left), dropped


def _records(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    recorded: Collection[str],
    dropped: list[str],
) -> Record:
    """The record table without the patterns of outputs that are not there."""
    variables = []
    for pattern in scenario.record.variables:
        name, _, rest = pattern.partition(".")
        may_lack = name in interfaces and (name in recorded or pattern in scenario.of_replaced)
        if may_lack and not any(
            rest == v.name or fnmatchcase(v.name, rest) for v in interfaces[name].of("output")
        ):
            dropped.append(f"record {pattern}: not in {_kind(name, recorded)}")
        else:
            variables.append(pattern)
    return scenario.record.model_copy(update={"variables": variables})


def _metrics(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    recorded: Collection[str],
    dropped: list[str],
) -> Metrics:
    """The metrics without those of outputs that are not there."""
    metrics: dict[str, int | str] = {"cycles": scenario.metrics.cycles}
    for key, text in scenario.metrics.defined.items():
        may_lack = interfaces if key in scenario.of_replaced else recorded
        missing = _missing(text, may_lack, interfaces)
        if missing:
            kind = _kind(missing.partition(".")[0], recorded)
            dropped.append(f"metric {key}: {missing} is not in {kind}")
        else:
            metrics[key] = text
    return Metrics.model_validate(metrics)


def _drops_wire(
    wire: Wire,
    scenario: Scenario,
    interfaces: dict[str, Interface],
    recorded: Collection[str],
    dropped: list[str],
    problems: Problems,
) -> bool:
    """Whether a wire is dropped; a problem is noted where an end that it needs is missing."""
    shown = f"wire {wire.source} -> {wire.target}"
    if wire.target.partition(".")[0] in recorded:
        dropped.append(f"{shown}: a recording has no inputs")
        return True
    name, _, rest = wire.source.partition(".")
    if name not in recorded or rest in interfaces[name].variables:
        return False
    target, _, port = wire.target.partition(".")
    inputs = interfaces[target].port(port, "input") if target in interfaces else []
    first = inputs[0] if inputs else None
    members = {v.member for v in interfaces[name].port(rest, "output")}
    if first is None or first.member in members:
        return False
    if any(key.startswith(f"{wire.target}.") for key in scenario.hold):
        dropped.append(f"{shown}: not in the recording; held instead")
        return True
    wanted = f"{rest}.{first.member}"
    from ..recording.named_column import in_scenario

    columns = interfaces[name].variables
    problems.add(
        f"wires {printable(wire.source)} -> {printable(wire.target)}",
        f"the recording has no column {printable(wanted)}; {nearest(wanted, columns)};"
        f" say which column it is, as {in_scenario(columns, wanted)}, record it,"
        f' or hold "{target}.{first.name}"',
    )
    return True


def _kind(name: str, recorded: Collection[str]) -> str:
    """How a message calls what stands in the place of a part."""
    return "the recording" if name in recorded else "the FMU in its place"


def _missing(text: str, components: Collection[str], interfaces: dict[str, Interface]) -> str:
    """The first variable of a metric that one of the components lacks; "" where they have all."""
    try:
        variables = expression_of(text).variables
    except ValueError:
        return ""
    for variable in variables:
        name, _, rest = variable.partition(".")
        if name in components and rest not in interfaces[name].variables:
            return variable
    return ""


def _kept(action: ActionSpec, recorded: Collection[str], dropped: list[str]) -> ActionSpec:
    """An action without the values that it sets in recordings."""
    kept = {}
    for name, value in action.set.items():
        if name.partition(".")[0] in recorded:
            dropped.append(f"action on {name} at {action.at}: a recording has no parameters")
        else:
            kept[name] = value
    return action.model_copy(update={"set": kept}) if len(kept) < len(action.set) else action
