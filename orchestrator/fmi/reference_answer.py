"""The reference answer of an FMU: outputs that are known for given inputs, held against its own."""

from __future__ import annotations

import csv
import math
import tempfile
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import FmuError, nearest, printable
from .archive import extract
from .description import Interface, read_interface
from .instance import in_process

START = "# start: "


@dataclass(frozen=True)
class Deviation:
    """The output that is furthest off, at a time [s]: `error` is by its largest reference value."""

    error: float
    variable: str
    time: float
    ours: float
    reference: float


@dataclass(frozen=True)
class ReferenceAnswer:
    """Start values, times [s], and the columns of inputs and outputs by their names, all SI."""

    start: dict[str, float | str]
    times: list[float]
    inputs: dict[str, list[float]]
    outputs: dict[str, list[float]]


def read_reference(path: Path, interface: Interface) -> ReferenceAnswer:
    """The reference answer in a CSV file, whose first line may be `# start: name=value, ...`.

    `FmuError` where it is not a table of numbers over `time`, or names what the FMU does not have.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise FmuError(f"{path}: cannot be read as text ({error})") from None
    start: dict[str, float | str] = {}
    skipped = 0
    if lines and lines[0].startswith(START):
        skipped = 1
        for pair in filter(None, map(str.strip, lines[0].removeprefix(START).split(","))):
            name, _, value = pair.partition("=")
            start[name.strip()] = _number(path, 1, value.strip())
    table = csv.reader(lines[skipped:])
    names = [name.strip() for name in next(table, [])]
    rows = []
    for cells in table:
        line = skipped + table.line_num
        if len(cells) != len(names):
            raise FmuError(f"{path}: line {line}: {len(cells)} values under {len(names)} names")
        rows.append({n: _number(path, line, c) for n, c in zip(names, cells, strict=True)})
    times = [row["time"] for row in rows] if "time" in names else []
    if not rows or not times or times[0] != 0.0 or any(b <= a for a, b in pairwise(times)):
        raise FmuError(f"{path}: needs a column time that rises from 0")
    known = {v.name: v.causality for v in interface.variables.values()}
    for name in [*start, *(key for key in rows[0] if key != "time")]:
        if known.get(name) not in {"input", "output", "parameter"}:
            raise FmuError(f"{path}: no variable {name!r}; {nearest(name, known)}")
    columns = {key: [row[key] for row in rows] for key in rows[0] if key != "time"}
    return ReferenceAnswer(
        start=start,
        times=times,
        inputs={name: values for name, values in columns.items() if known[name] == "input"},
        outputs={name: values for name, values in columns.items() if known[name] == "output"},
    )


def _number(path: Path, line: int, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise FmuError(f"{path}: line {line}: {printable(text)!r} is not a number") from None


def reference_deviation(path: Path, reference: Path) -> Deviation:
    """Drive an FMU that was built here with the inputs of a reference answer.

    Gives the largest deviation of its outputs. Raises `FmuError` where one of the files cannot be
    used, `InstanceFailure` where the FMU fails.
    """
    interface = read_interface(path)
    answer = read_reference(reference, interface)
    worst = Deviation(0.0, "", 0.0, 0.0, 0.0)
    inputs = [v for v in interface.of("input") if v.kind == "Real"]
    outputs = [v for v in interface.of("output") if v.name in answer.outputs]
    sizes = {name: max(map(abs, values)) or 1.0 for name, values in answer.outputs.items()}
    sent = np.array([float(v.start or 0.0) for v in inputs])
    got = np.zeros(len(outputs))
    with tempfile.TemporaryDirectory(prefix="resilin_reference_") as folder:
        extract(path, Path(folder))
        unit = in_process(path.stem, interface, Path(folder))
        try:
            unit.prepare(answer.start, 0.0, answer.times[-1], None)
            unit.connect(inputs, sent, [outputs], got)
            unit.enter_initialisation()
            for row, time in enumerate(answer.times):
                if row:
                    unit.step(answer.times[row - 1], time - answer.times[row - 1])
                for place, variable in enumerate(inputs):
                    if variable.name in answer.inputs:
                        sent[place] = answer.inputs[variable.name][row]
                unit.send()
                if not row:
                    unit.exit_initialisation()
                unit.receive()
                for variable, ours in zip(outputs, got, strict=True):
                    wanted = answer.outputs[variable.name][row]
                    error = abs(float(ours) - wanted) / sizes[variable.name]
                    if not math.isfinite(error):
                        error = math.inf
                    if error > worst.error:
                        worst = Deviation(error, variable.name, time, float(ours), wanted)
        finally:
            unit.close()
    return worst
