"""The two files that a build puts in the place of the sample's.

They are `record.json` and `generated_outputs.py`.

What a recording says comes from strangers. Names are checked to be names, every other text goes
into the source as a literal.
"""

from __future__ import annotations

import json
import keyword
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from numpy.typing import NDArray

from ..generated import literal
from ..units import exponents

How = Literal["column", "slope", "curvature", "square", "time", "event"]
NAME = re.compile(r"[A-Za-z_]\w*(\[\d+(,\d+)*\])?(\.[A-Za-z_]\w*(\[\d+(,\d+)*\])?)*")
NEVER = 1.0e30
MOST = 2_000_000
"""Numbers that a recording may come to as an FMU: about 40 MB of text."""


class TooLong(ValueError):
    """A recording that is no part any more but a file."""


@dataclass(frozen=True)
class ReplayedOutput:
    """One output: how it comes about, from which column, and which column is its rate (-1: none).

    `unit` is in SI as FMI writes it, "" where there is none.
    """

    name: str
    unit: str
    meaning: str
    port: str
    order: int
    how: How
    column: int = -1
    rate: int = -1


@dataclass(frozen=True)
class Record:
    """What is to be replayed; arrays as in :class:`orchestrator.recording.interpolation.Track`."""

    outputs: Sequence[ReplayedOutput]
    knots: NDArray[Any]
    pieces: NDArray[Any]
    last: NDArray[Any]
    first: NDArray[Any]
    second: NDArray[Any]
    events: Sequence[float]
    period: float
    grain: float


def files(record: Record) -> dict[str, bytes]:
    """Path in the tree -> text. :class:`TooLong` where that is beyond all use."""
    tables = (record.knots, record.pieces, record.first, record.second)
    count = sum(table.size for table in tables)
    if count > MOST:
        raise TooLong(
            f"comes to {count} numbers, more than {MOST}: take fewer rows or columns, or give it"
            " to a scenario as data = ..., which needs no FMU"
        )
    return {
        "replay/record.json": json.dumps(_numbers(record)).encode(),
        "replay/generated_outputs.py": source(record.outputs).encode(),
    }


def _numbers(record: Record) -> dict[str, Any]:
    return {
        "knots": record.knots.tolist(),
        "pieces": record.pieces.transpose(2, 0, 1).tolist(),
        "last": record.last.tolist(),
        "first": record.first.T.tolist(),
        "second": record.second.T.tolist(),
        "events": [*record.events, NEVER],
        "period": record.period,
        "grain": record.grain,
    }


def source(outputs: Sequence[ReplayedOutput]) -> str:
    """Text of `generated_outputs.py`."""
    fields = _fields(outputs)
    return "\n".join(
        [
            '"""Outputs of the record, made by the build from its columns; nothing to edit."""',
            "",
            "from __future__ import annotations",
            "",
            "from dataclasses import dataclass",
            "",
            "from ..quantity import provided",
            f"from .interpolation import {', '.join(_used(outputs))}",
            "",
            "",
            "@dataclass(frozen=True)",
            "class Output:",
            '    """Columns of the record, and members of laws that follow from them."""',
            "",
            *(line for field, output in fields.items() for line in _declared(field, output)),
            "",
            "",
            "def outputs_at(time: float, offset: float, size: float, before: float, after: float)"
            " -> Output:",
            '    """Outputs at a time, at the end of a step of this size [s]; 0 for none yet."""',
            *_places(outputs),
            *(line for field, output in fields.items() for line in _worked_out(field, output)),
            "    return Output(",
            *(f"        {field}={field}," for field in fields),
            "    )",
            "",
        ]
    )


def _fields(outputs: Sequence[ReplayedOutput]) -> dict[str, ReplayedOutput]:
    """A Python name for each output."""
    taken = {"time", "offset", "size", "before", "after", "here", "start", "side"}
    made: dict[str, ReplayedOutput] = {}
    for output in outputs:
        if not NAME.fullmatch(output.name) or (output.port and not NAME.fullmatch(output.port)):
            raise ValueError(f"{output.name!r} is not the name of a variable")
        if output.unit:
            exponents(output.unit)
        field = re.sub(r"\W+", "_", output.name).strip("_") or "x"
        while field in taken or field in made or keyword.iskeyword(field) or field in _FUNCTIONS:
            field += "_"
        made[field] = output
    return made


_FUNCTIONS = {
    "place", "edge", "value", "slope", "curvature", "square_curvature", "next_event",
    "Output", "outputs_at", "provided", "dataclass", "annotations",
}  # fmt: skip


def _used(outputs: Sequence[ReplayedOutput]) -> list[str]:
    """Names of `interpolation.py` that the outputs call for."""
    lines = [*_places(outputs), *(line for output in outputs for line in _worked_out("x", output))]
    called = {name for line in lines for name in re.findall(r"(\w+)\(", line)}
    return sorted(called)


def _places(outputs: Sequence[ReplayedOutput]) -> list[str]:
    """Assignments of the places that the outputs are looked up at."""
    lines = []
    if any(output.how in {"column", "curvature", "square"} for output in outputs):
        lines.append("    here = place(time - offset)")
    if any(output.how in {"curvature", "square"} for output in outputs):
        lines.append("    start = place(time - offset - size)")
    if any(output.how == "slope" or (output.how in {"curvature", "square"} and output.rate < 0)
           for output in outputs):  # fmt: skip
        lines.append("    side = edge(time - offset, size)")
    return lines


def _declared(field: str, output: ReplayedOutput) -> list[str]:
    return [
        f"    {field}: float = provided(",
        f"        {literal(output.unit)},",
        f"        {literal(output.meaning)},",
        f"        name={literal(output.name)},",
        f"        port={literal(output.port)},",
        f"        order={int(output.order)},",
        "    )",
    ]


def _worked_out(field: str, output: ReplayedOutput) -> list[str]:
    """Assignment of one output."""
    if output.how == "time":
        return [f"    {field} = time"]
    if output.how == "event":
        return [f"    {field} = next_event(time - offset) + offset"]
    j = int(output.column)
    if output.how == "column":
        return [f"    {field} = value({j}, here, before, after)"]
    if output.how == "slope":
        return [f"    {field} = slope({j}, side)"]
    rate = f"slope({j}, side)"
    if output.rate >= 0:
        rate = f"value({int(output.rate)}, here, before, after)"
    function = "curvature" if output.how == "curvature" else "square_curvature"
    return [f"    {field} = {function}({j}, {rate}, start, here, size, before, after)"]
