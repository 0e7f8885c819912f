"""What a part offers: its parameters, and its ports with their members."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ..errors import printable
from ..fmi.archive import read_description
from ..fmi.description import Interface, Variable, read_interface
from ..fmi.safe_xml import guarded
from ..report.whole_names import keep_whole
from .library import LIBRARY, built_part, located, part_names

if TYPE_CHECKING:
    from rich.table import Table

Row = TypeVar("Row")

PARAMETERS = ("parameter", "structuralParameter")
DIRECTIONS = {"input": "in", "output": "out"}
PROVENANCE = "; provenance: "
"""Between meaning and provenance in the descriptions of the package's own FMUs."""

MOST_ROWS = 500
"""Rows of a table; `--json` gives what is more."""
LAWS = ("value", "affine", "curvature")
"""What a member is to its port, by its order: the value, or a part of its law."""


def parts(library: Path = LIBRARY) -> dict[str, Interface]:
    """The built parts by name: variables with unit, start value, range and meaning; ports.

    `FmuError` where a file of the library is not an FMU.
    """
    found = located(library)
    return {name: read_interface(built_part(name, found)) for name in part_names(found)}


def description_of(path: Path) -> str:
    """What an FMU says of itself in one line; `FmuError` where it is not one."""
    root = guarded(f"{path}: modelDescription.xml", read_description(path))
    return printable(str(root.get("description") or ""))


def part_tables(part: Interface) -> list[Table]:
    """Parameters with start value, range and meaning; inputs and outputs, port by port."""
    tables = (_parameters(part), _ports(part))
    return [keep_whole(table, 0) for table in tables if table.row_count]


def part_facts(part: Interface) -> dict[str, Any]:
    """The same as data for scripts."""
    return {
        "fmu": str(part.path),
        "description": description_of(part.path),
        "guid": part.guid,
        "fmi": part.version,
        "rollback": part.rollback,
        "variable_step": part.variable_step,
        "model_exchange": part.model_exchange,
        "parameters": {
            v.name: {
                "start": start_of(v),
                "unit": v.unit,
                "least": v.least,
                "most": v.most,
                "choices": list(v.choices),
                "tunable": v.tunable,
                "meaning": meaning_of(v),
                "provenance": provenance_of(v),
            }
            for v in part.of(*PARAMETERS)
        },
        "ports": [
            {
                "port": port,
                "direction": direction,
                "members": {
                    v.name: {"unit": v.unit, "order": v.order, "meaning": v.description}
                    for v in members
                },
            }
            for port, direction, members in _by_port(part)
        ],
    }


def meaning_of(variable: Variable) -> str:
    """The description of a variable without its provenance."""
    return variable.description.partition(PROVENANCE)[0]


def provenance_of(variable: Variable) -> str:
    """Where the number of a parameter comes from, "" where its FMU does not say."""
    return variable.description.partition(PROVENANCE)[2]


def start_of(variable: Variable) -> float | str | None:
    """Start value of a parameter; a choice by its name."""
    if variable.choices and variable.start is not None:
        code = int(float(variable.start))
        return variable.choices[variable.codes.index(code)] if code in variable.codes else code
    return variable.start


def _parameters(part: Interface) -> Table:
    from rich.table import Table

    sources = any(provenance_of(v) for v in part.of(*PARAMETERS))
    table = Table("parameter", "start", "range", "meaning", title="parameters")
    if sources:
        table.add_column("provenance")
    table.columns[1].justify = "right"
    for v in _cut(table, part.of(*PARAMETERS)):
        start = start_of(v)
        number = f"{start:.6g}" if isinstance(start, float) else printable(str(start or ""))
        unit = "" if v.unit in {"", "1"} else f" {printable(v.unit)}"
        tunable = " (tunable)" if v.tunable else ""
        row = [printable(v.name), f"{number}{unit}", _range(v), printable(meaning_of(v)) + tunable]
        table.add_row(*row, *([printable(provenance_of(v))] if sources else []))
    return table


def _cut(table: Table, rows: Sequence[Row]) -> Sequence[Row]:
    """The first of the rows; the table says how many there are beyond them."""
    if len(rows) > MOST_ROWS:
        table.caption = f"and {len(rows) - MOST_ROWS} more: --json gives all"
    return rows[:MOST_ROWS]


def _range(variable: Variable) -> str:
    """Choices, or the bounds that the FMU states, in the unit of the start value."""
    if variable.choices:
        return ", ".join(map(printable, variable.choices))
    if variable.kind == "Boolean":
        return "true, false"
    least, most = variable.least, variable.most
    if least is not None and most is not None:
        return f"{least:g} to {most:g}"
    if least is not None:
        return f"from {least:g}"
    return "" if most is None else f"to {most:g}"


def _ports(part: Interface) -> Table:
    from rich.table import Table

    table = Table("input or output", "", "order", "unit", "meaning", title="ports")
    members = [
        (direction, member) for _, direction, members in _by_port(part) for member in members
    ]
    for direction, v in _cut(table, members):
        order = LAWS[v.order] if v.order < len(LAWS) else str(v.order)
        unit = "" if v.unit == "1" else printable(v.unit)
        table.add_row(printable(v.name), direction, order, unit, printable(v.description))
    return table


def _by_port(part: Interface) -> Iterator[tuple[str, str, list[Variable]]]:
    """Ports, and variables in none, with direction and members; inputs first."""
    for causality, direction in DIRECTIONS.items():
        groups: dict[str, list[Variable]] = {}
        for v in part.of(causality):
            groups.setdefault(v.port or v.name, []).append(v)
        for port, members in groups.items():
            yield port, direction, members
