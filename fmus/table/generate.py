"""The two files that a build puts in the place of the sample's, from points of a relation.

They are `table.json` and `generated_ports.py`. Names come from strangers: they are checked to be
names, every other text goes into the source as a literal.
"""

from __future__ import annotations

import json
import keyword
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..generated import literal
from ..units import exponents

NAME = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*")
WIDTH = 100
MOST = 2_000_000
"""Coefficients that a table may come to as an FMU."""
LAWS = {
    ("value", "N", "displacement", "m"): ("stiffness", "N/m", -1.0, "reference_displacement"),
    ("value", "N", "velocity", "m/s"): ("damping", "N.s/m", -1.0, "reference_velocity"),
    ("torque", "N.m", "flap_rate", "rad/s"): ("damping", "N.m.s", -1.0, "reference_rate"),
    ("added_inertia", "kg.m2", "flap_rate", "rad/s"): (
        "added_inertia_slope", "kg.m2.s", 1.0, "reference_rate",
    ),
}  # fmt: skip
"""Members of an output and of an argument, with their units -> the member of a law that is the
slope, its unit and sign, and the member that says where the law holds."""
HERMITE = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [-3, 3, -2, -1], [2, -2, 1, 1]], dtype=float)
"""Ends and slopes of a cubic on 0 to 1 -> its coefficients."""
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """A variable of the relation; `unit` in SI as FMI writes it, "" where there is none."""

    name: str
    unit: str

    @property
    def port(self) -> str:
        return self.name.rpartition(".")[0]

    @property
    def member(self) -> str:
        return self.name.rpartition(".")[2]

    @property
    def field(self) -> str:
        """Name of the dataclass field, which may not be a word of Python."""
        plain = self.name.replace(".", "_")
        return f"{plain}_" if keyword.iskeyword(plain) else plain


@dataclass(frozen=True)
class Relation:
    """Outputs over the points of one argument, or over the grid of two.

    `values` has the shape (outputs, points of the first, points of the second argument).
    """

    arguments: tuple[Column, ...]
    outputs: tuple[Column, ...]
    knots: tuple[Array, ...]
    values: Array


def relation(columns: Sequence[Column], rows: Array) -> Relation:
    """The relation of a table of numbers: a column each, the arguments first.

    There is one argument where the first column has no value twice, else two, and a row for each
    of their pairs. `ValueError` says what is wrong.
    """
    names = [column.name for column in columns]
    _check_names(columns)
    first = np.unique(rows[:, 0])
    count = 1 if len(first) == len(rows) else 2
    if len(columns) <= count:
        raise ValueError(
            f"{', '.join(names)}: no column is left for an output"
            + (f": {names[0]} has values more than once, so that it is one of two arguments"
               if count == 2 else "")
        )  # fmt: skip
    knots = tuple(np.unique(rows[:, k]) for k in range(count))
    for name, values in zip(names, knots, strict=False):
        if len(values) < 2:
            raise ValueError(f"{name}: has one value; a table needs two at least")
    shape = tuple(len(values) for values in knots)
    places = tuple(np.searchsorted(knots[k], rows[:, k]) for k in range(count))
    seen = np.zeros(shape, dtype=int)
    np.add.at(seen, places, 1)
    for what, wrong in (("is there more than once", seen > 1), ("is missing", seen == 0)):
        if wrong.any():
            at = np.argwhere(wrong)[0]
            point = ", ".join(f"{names[k]} = {knots[k][i]:g}" for k, i in enumerate(at))
            raise ValueError(f"the point {point} {what}: a grid has each pair once")
    table = np.empty((len(columns) - count, *shape))
    for k in range(count, len(columns)):
        table[k - count][places] = rows[:, k]
    if count == 1:
        table = np.repeat(table[:, :, None], 2, axis=2)
        knots = (*knots, np.array([0.0, 1.0]))
    return Relation(tuple(columns[:count]), tuple(columns[count:]), knots, table)


def _check_names(columns: Sequence[Column]) -> None:
    names = [column.name for column in columns]
    for column in columns:
        if not NAME.fullmatch(column.name):
            raise ValueError(f"{column.name!r} is not the name of a variable, as load.torque")
        if column.unit:
            exponents(column.unit)
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise ValueError(f"{sorted(twice)[0]} is the name of two columns")


def files(given: Relation) -> dict[str, bytes]:
    """Path in the tree -> text; `ValueError` where the table is beyond all use."""
    cells = (len(given.knots[0]) - 1) * (len(given.knots[1]) - 1)
    if (count := 16 * cells * len(given.outputs)) > MOST:
        raise ValueError(f"comes to {count} coefficients, more than {MOST}: take fewer points")
    numbers = {
        "first": given.knots[0].tolist(),
        "second": given.knots[1].tolist(),
        "pieces": [
            pieces(given.knots[0], given.knots[1], values).tolist() for values in given.values
        ],
    }
    return {
        "table/table.json": f"{json.dumps(numbers)}\n".encode(),
        "table/generated_ports.py": source(given).encode(),
    }


def pieces(first: Array, second: Array, values: Array) -> Array:
    """Coefficients of each cell, (cells, 16): bicubic, with the slopes of monotone cubics."""
    from scipy.interpolate import PchipInterpolator

    def slopes(knots: Array, given: Array, axis: int) -> Array:
        return np.asarray(PchipInterpolator(knots, given, axis=axis).derivative()(knots))

    across, along = slopes(first, values, 0), slopes(second, values, 1)
    both = slopes(first, along, 0)
    made = []
    for i, width in enumerate(np.diff(first)):
        for j, height in enumerate(np.diff(second)):
            corner = np.ix_([i, i + 1], [j, j + 1])
            known = np.block(
                [
                    [values[corner], height * along[corner]],
                    [width * across[corner], width * height * both[corner]],
                ]
            )
            made.append((HERMITE @ known @ HERMITE.T).ravel())
    return np.array(made)


@dataclass(frozen=True)
class Member:
    """An output of the part: its column, and the expression that gives it."""

    column: Column
    meaning: str
    order: int
    expression: str


def members(given: Relation) -> list[Member]:
    """The table's outputs, the members of laws that follow from them, and all other slopes."""
    over = " and ".join(column.name for column in given.arguments)
    made = [
        Member(column, f"Tabulated over {over}", 0, f"value({k}, here, how, beyond)")
        for k, column in enumerate(given.outputs)
    ]
    taken = {column.name for column in given.outputs}
    for k, output in enumerate(given.outputs):
        for which, argument in zip(("first", "second"), given.arguments, strict=False):
            slope = f"{which}_slope({k}, here, how, beyond)"
            law = _law(output, argument)
            for member in _derived(output, argument, slope, law):
                if member.column.name not in taken:
                    taken.add(member.column.name)
                    made.append(member)
    return made


def _law(output: Column, argument: Column) -> tuple[str, str, float, str] | None:
    """The law that a slope is a member of, whatever the units are written as."""
    if not (output.port and output.unit and argument.unit):
        return None
    for (member, unit, other, over), law in LAWS.items():
        same = exponents(unit) == exponents(output.unit) and exponents(over) == exponents(
            argument.unit
        )
        if (member, other) == (output.member, argument.member) and same:
            return law
    return None


def _derived(
    output: Column, argument: Column, slope: str, law: tuple[str, str, float, str] | None
) -> list[Member]:
    meaning = f"d({output.name})/d({argument.name})"
    if law is None:
        unit = _quotient(output.unit, argument.unit)
        name = Column(f"{output.name}_by_{argument.member}", unit)
        return [Member(name, meaning, 1 if output.port else 0, slope)]
    member, unit, sign, point = law
    first = Member(
        Column(f"{output.port}.{member}", unit),
        meaning if sign > 0.0 else f"-{meaning}",
        1,
        slope if sign > 0.0 else f"-{slope}",
    )
    where = Column(f"{output.port}.{point}", argument.unit)
    return [first, Member(where, "Where the law holds", 1, f"u.{argument.field}")]


def _quotient(unit: str, other: str) -> str:
    """A unit by another one, in base units."""
    if not unit or not other:
        return ""
    powers = dict(exponents(unit))
    for base, power in exponents(other).items():
        powers[base] = powers.get(base, 0) - power
    above = [f"{b}{p if p > 1 else ''}" for b, p in powers.items() if p > 0]
    below = [f"/{b}{-p if p < -1 else ''}" for b, p in powers.items() if p < 0]
    return (".".join(above) or "1") + "".join(below)


def source(given: Relation) -> str:
    """Text of `generated_ports.py`."""
    outputs = members(given)
    used = sorted({name for m in outputs for name in re.findall(r"(\w+)\(", m.expression)})
    first, second = (f"u.{c.field}" for c in (*given.arguments, *given.arguments)[:2])
    if len(given.arguments) == 1:
        second = "0.0"
    depends = tuple(column.name for column in given.arguments)
    limits = [("LOW", "HIGH"), ("BOTTOM", "TOP")][: len(given.arguments)]
    lines = [
        '"""Inputs and outputs of the table, made by the build from its columns."""',
        "",
        "from __future__ import annotations",
        "",
        "from dataclasses import dataclass",
        "",
        "from ..quantity import provided, received",
        f"from .data import {', '.join(sorted(name for pair in limits for name in pair))}",
        f"from .relation import {', '.join(sorted([*used, 'outside', 'place']))}",
        "",
        "",
        "@dataclass(frozen=True)",
        "class Input:",
        '    """Arguments of the table."""',
        "",
    ]
    for column, knots in zip(given.arguments, given.knots, strict=False):
        start = float(min(max(0.0, knots[0]), knots[-1]))
        lines += [
            f"    {column.field}: float = received(",
            f"        {start!r},",
            f"        {literal(column.unit)},",
            '        "Argument of the table",',
            f"        port={literal(column.port)},",
            f"        name={literal(column.name)},",
            "    )",
        ]
    lines += [
        "",
        "",
        "@dataclass(frozen=True)",
        "class Output:",
        '    """What the table gives, and the slopes of it."""',
        "",
    ]
    for member in outputs:
        lines += [
            f"    {member.column.field}: float = provided(",
            f"        {literal(member.column.unit)},",
            f"        {literal(member.meaning)},",
            f"        port={literal(member.column.port)},",
            f"        order={member.order},",
            f"        depends=({', '.join(map(literal, depends))},),",
            f"        name={literal(member.column.name)},",
            "    )",
        ]
    lines += [
        "",
        "",
        "def check_inside(u: Input) -> bool:",
        '    """`ValueError` where an argument is outside of the table; else true."""',
    ]
    for column, knots, (low, high) in zip(given.arguments, given.knots, limits, strict=False):
        words = f"{column.name} is outside of the table, {knots[0]:g} to {knots[-1]:g}"
        words = f"{words} {column.unit}".rstrip() + ": outside = hold or extend"
        lines.append(f"    if outside(u.{column.field}, {low}, {high}):")
        raised = f"        raise ValueError({literal(words)})"
        if len(raised) > WIDTH:
            raised = f"        raise ValueError(\n            {literal(words)}\n        )"
        lines.append(raised)
    lines += [
        "    return True",
        "",
        "",
        "def outputs_at(u: Input, how: float, beyond: float) -> Output:",
        '    """Outputs at the arguments; `how` and `beyond` are parameters of the part."""',
        f"    here = place({first}, {second})",
        "    return Output(",
        *(f"        {m.column.field}={m.expression}," for m in outputs),
        "    )",
        "",
    ]
    return "\n".join(lines)
