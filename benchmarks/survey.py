"""What becomes of every FMU in a folder: read, read with warnings, refused and why; and run.

    python benchmarks/survey.py FOLDER            # or the environment variable RESILIN_FMUS
    python benchmarks/survey.py FOLDER --run      # ten steps of each that is read, inputs held

FMUs are found at any depth. With `--run` each one steps in a process of its own.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orchestrator.errors import ResilinError, printable
from orchestrator.fmi.description import Interface, examined
from orchestrator.scenario.parse import scenario_of
from orchestrator.simulation.load import planned
from orchestrator.simulation.run import run

STEPS = 10
STEP = 0.01
"""Steps of a run, and their size [s] where the FMU prefers none."""


@dataclass(frozen=True)
class Row:
    """One FMU: its path in the folder, FMI version, tool, what became of it, and why."""

    name: str
    version: str
    tool: str
    verdict: str
    reason: str = ""


def surveyed(folder: Path, *, runs: bool = False) -> list[Row]:
    """A row for each FMU below a folder, in the order of their names."""
    return [_row(path, folder, runs) for path in sorted(folder.rglob("*.fmu"))]


def _row(path: Path, folder: Path, runs: bool) -> Row:
    name = str(path.relative_to(folder))
    try:
        interface, found = examined(path)
    except ResilinError as error:
        return Row(name, "", "", "refused", str(error).removeprefix(f"{path}: "))
    if interface is None:
        return Row(name, "", "", "refused", found.errors[0])
    verdict = "read with warnings" if found.warnings else "read"
    reason = "; ".join(found.warnings[:1])
    if runs:
        try:
            _run(path, interface)
            verdict += ", runs"
        except ResilinError as error:
            verdict, reason = f"{verdict}, fails", str(error)
    return Row(name, str(interface.version), interface.tool, verdict, reason)


def _run(path: Path, interface: Interface) -> None:
    """Ten steps with all inputs held at their start values."""
    step = interface.step or STEP
    hold: dict[str, Any] = {}
    for variable in interface.of("input"):
        if variable.numeric:
            value: Any = variable.start or 0.0
            if variable.choices:
                known = dict(zip(variable.codes, variable.choices, strict=True))
                value = known.get(int(value), variable.choices[0])
            hold[f"fmu.{variable.name}"] = bool(value) if variable.kind == "Boolean" else value
    tree = {
        "components": {"fmu": {"fmu": str(path.resolve())}},
        "hold": hold,
        "time": {"stop": STEPS * step, "step": step},
    }
    scenario = path.with_suffix(".toml")
    run(planned(scenario_of(tree, scenario), scenario), estimate=False).checked()


def printed(rows: list[Row]) -> str:
    """The rows as a Markdown table, with the counts of verdicts under it."""
    lines = ["| FMU | FMI | tool | verdict | why |", "|---|---|---|---|---|"]
    for row in rows:
        cells = (row.name, row.version, row.tool, row.verdict, row.reason)
        shown = (printable(cell, most=160).replace("|", "\\|") for cell in cells)
        lines.append(f"| {' | '.join(shown)} |")
    counts = Counter(row.verdict for row in rows)
    total = ", ".join(f"{count} {verdict}" for verdict, count in counts.most_common())
    return "\n".join([*lines, "", f"{len(rows)} FMUs: {total or 'none'}"])


def main(arguments: list[str]) -> int:
    """Print the survey of a folder; 2 where there is none."""
    parser = argparse.ArgumentParser(description="What becomes of every FMU in a folder.")
    parser.add_argument("folder", nargs="?", default=os.environ.get("RESILIN_FMUS"))
    parser.add_argument("--run", action="store_true", help="ten steps of each FMU too")
    given = parser.parse_args(arguments)
    if not given.folder or not Path(given.folder).is_dir():
        print("name a folder of FMUs, or set RESILIN_FMUS", file=sys.stderr)
        return 2
    print(printed(surveyed(Path(given.folder), runs=given.run)))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
