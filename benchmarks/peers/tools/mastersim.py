"""MasterSim: a compiled master with a command line; it reads a project that is written here."""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

from ..case import Case
from .base import March, Method, Tool, Track

COMMAND = "RESILIN_MASTERSIM"
"""Environment variable with the path of its command, `MasterSimulator` or `mastersim`."""
MODES = {"gauss-seidel": "GAUSS_SEIDEL", "jacobi": "GAUSS_JACOBI"}


class MasterSim(Tool):
    """Its own clock counts, without the text that it writes of each step; loading is not in it."""

    name = "mastersim"
    distribution = "MasterSim"
    install = f"build it without its user interface, and set {COMMAND} to its command"
    methods = tuple(Method(name) for name in MODES)

    def version(self) -> str:
        told = subprocess.run(
            [os.environ[COMMAND], "--version"], capture_output=True, text=True, check=False
        )
        found = re.search(r"\d+(\.\d+)+", told.stdout)
        return found.group() if found else "unknown"

    def missing(self) -> str:
        command = os.environ.get(COMMAND, "")
        if not command:
            return f"{COMMAND} is not set"
        return "" if shutil.which(command) else f"{command} is no command"

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            project = folder / "case.msim"
            project.write_text(project_text(case, MODES[method]), encoding="utf-8")
            command = [os.environ[COMMAND], "--verbosity-level=0", "-x", str(project)]

            def march() -> Track:
                begun = perf_counter()
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                whole = perf_counter() - begun
                if done.returncode:
                    raise RuntimeError(_reason(done))
                track = _track(case, folder / "case")
                track.aside = whole - _stepping(folder / "case" / "log" / "summary.txt")
                return track

            yield march


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    """What it says of a failure, without colours and its hint at other options."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", f"{done.stdout}\n{done.stderr}")
    lines = [line.strip() for line in plain.splitlines() if line.strip()]
    told = [line for line in lines if "verbosity-level" not in line]
    return told[-1] if told else f"exit code {done.returncode}"


def project_text(case: Case, mode: str) -> str:
    """A project of MasterSim: fixed steps, one pass, the values of every step."""
    size = repr(case.step)
    lines = [
        "tStart 0 s",
        f"tEnd {case.count * case.step!r} s",
        *(f"{key} {size} s" for key in ("hMax", "hMin", "hFallBackLimit", "hStart")),
        f"hOutputMin {0.5 * case.step!r} s",
        "outputTimeUnit s",
        "adjustStepSize no",
        "preventOversteppingOfEndTime no",
        f"MasterMode {mode}",
        "ErrorControlMode NONE",
        "maxIterations 1",
        "writeInternalVariables no",
    ]
    for place, component in enumerate(case.components):
        lines.append(f'simulator {place} 0 {component.name} #ff8c00 "{component.path}"')
    for wire in case.wires:
        lines.append(f"graph {wire.source}.{wire.output} {wire.target}.{wire.input}")
    for component in case.components:
        lines += [f"parameter {component.name}.{s.name} {s.value!r}" for s in component.starts]
    return "\n".join([*lines, ""])


def _track(case: Case, folder: Path) -> Track:
    """Watched values at the points of comparison, from the text of all steps."""
    with (folder / "results" / "values.csv").open(encoding="utf-8") as file:
        heading, *rows = csv.reader(file, delimiter="\t")
    names = [text.partition(" [")[0].strip() for text in heading]
    columns = [names.index(f"{w.component}.{w.name}") for w in case.watched]
    kept = rows[case.every :: case.every]
    return Track(
        [float(row[0]) for row in kept],
        [[float(row[k]) for k in columns] for row in kept],
        case.count * len(case.components),
    )


def _stepping(summary: Path) -> float:
    """Seconds by its own clock, without what the writing of results took."""
    lines = (line.partition("=") for line in summary.read_text(encoding="utf-8").splitlines())
    told = {name: value for name, _, value in lines}
    return float(told["WallClockTime"]) - float(told["FrameworkTimeWriteOutputs"])
