"""What a checked scene is made of, as tables: units, connections, held inputs, time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .interface import Variable
from .wiring import Connection, Plan

if TYPE_CHECKING:
    from rich.table import Table

LAWS = ("value", "affine", "curvature")


def tables(plan: Plan) -> list[Table]:
    """Units in the order in which they are stepped, wires by port, held inputs, the grid."""
    return [_units(plan), _wires(plan), _held(plan), _time(plan)]


def _units(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("unit", "FMU", "GUID", "rollback", "ports", "start values", title="units")
    for name in plan.order:
        interface = plan.interfaces[name]
        starts = [
            f"{key} = {_shown(interface.variables[key], value)}"
            for key, value in plan.starts[name].items()
        ]
        table.add_row(
            name,
            interface.path.name,
            interface.guid[:8],
            "yes" if interface.rollback else "no",
            ", ".join(interface.ports()),
            ", ".join(starts),
        )
    return table


def _shown(variable: Variable, value: float | str) -> str:
    """A start value with its unit, or the name of the choice."""
    if variable.choices:
        return variable.choices[int(float(value)) - 1]
    if isinstance(value, str):
        return value
    unit = "" if variable.unit == "1" else f" {variable.unit}"
    return f"{value:.6g}{unit}"


def _wires(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("from", "to", "values", "affine", "curvature", title="connected members")
    groups: dict[tuple[str, str], list[Connection]] = {}
    for c in plan.connections:
        ends = (
            f"{c.source}.{c.output.port or c.output.name}",
            f"{c.target}.{c.input.port or c.input.name}",
        )
        groups.setdefault(ends, []).append(c)
    for (source, target), members in groups.items():
        counts = [sum(c.input.order == order for c in members) for order in range(len(LAWS))]
        table.add_row(source, target, *(str(count) for count in counts))
    return table


def _held(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("held input", "value", "unit", title="held")
    for key, value in plan.held.items():
        component, _, name = key.partition(".")
        table.add_row(key, f"{value:g}", plan.interfaces[component].variables[name].unit)
    return table


def _time(plan: Plan) -> Table:
    from rich.table import Table

    grid = plan.grid
    table = Table("start", "stop", "step", "steps", "frequency", "recorded", title="time")
    frequency = f"{plan.frequency:g} Hz" if plan.frequency else "none"
    table.add_row(
        f"{grid.start:g} s", f"{grid.stop:g} s", f"{grid.step:.6g} s", str(grid.count),
        frequency, f"{len(plan.records)} variables",
    )  # fmt: skip
    return table
