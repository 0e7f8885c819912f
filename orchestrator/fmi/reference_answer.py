"""The reference answer of an FMU: outputs that are known for given inputs, held against its own."""

from __future__ import annotations

import csv
import io
import math
import tempfile
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import FmuError, nearest
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
        text = path.read_text(encoding="utf-8")
        head, _, body = text.partition("\n") if text.startswith(START) else ("", "", text)
        pairs = [pair.split("=") for pair in head.removeprefix(START).split(", ") if "=" in pair]
        start: dict[str, float | str] = {key.strip(): float(value) for key, value in pairs}
        rows = [
            {key: float(value) for key, value in row.items()}
            for row in csv.DictReader(io.StringIO(body), strict=True)
        ]
        times = [row["time"] for row in rows]
    except (OSError, ValueError, TypeError, KeyError, csv.Error) as error:
        raise FmuError(f"{path}: is no reference answer ({error!r})") from None
    if not rows or times[0] != 0.0 or any(b <= a for a, b in pairwise(times)):
        raise FmuError(f"{path}: its times have to rise from 0")
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
