"""One setting of one tool, run in a process of its own within a budget, and its result."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from typing import Any

from .case import Case
from .child import LONG

LOADING = 40.0
"""Seconds beside the budget that a process has for loading and repeats."""


@dataclass(frozen=True)
class Setting:
    """A tool's method with a wiring at one `place` of what is varied: `steps` or `tolerance`."""

    tool: str
    method: str
    wiring: str
    varied: str
    place: float

    @property
    def curve(self) -> tuple[str, str, str]:
        return self.tool, self.method, self.wiring

    def __str__(self) -> str:
        what = f"{self.place:g} per cycle" if self.varied == "steps" else f"rtol {self.place:g}"
        return f"{self.tool}, {self.method}, {self.wiring}, {what}"


@dataclass
class MeasuredRun:
    """Cost and result of a setting. `status`: done, stopped (by an error of the tool), crashed,
    over budget, not installed; `reason` has the details. Figures are filled in by `figures`."""

    setting: Setting
    status: str
    reason: str = ""
    version: str = ""
    wall: float = nan
    calls: int = 0
    times: list[float] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)
    error: float = nan
    order: float = nan
    stroke: float = nan
    travel: float = nan
    frequency: float = nan


def run(case: Case, setting: Setting, budget: float, repeats: int, python: str = "") -> MeasuredRun:
    """The run of a setting; a process that crashes or takes too long is a result too."""
    home = Path(__file__).resolve().parent.parent
    before = os.environ.get("PYTHONPATH", "")
    path = os.pathsep.join([str(home), *([before] if before else [])])
    with tempfile.TemporaryDirectory(prefix="peers_") as folder:
        given, result = Path(folder) / "case.json", Path(folder) / "result.json"
        case.write(given)
        command = [python or sys.executable, "-m", "peers.child", str(given), setting.tool]
        command += [setting.method, str(repeats), str(result)]
        with (Path(folder) / "output").open("wb+") as output:
            child = subprocess.Popen(
                command, stdout=output, stderr=output, start_new_session=True,
                env={**os.environ, "PYTHONPATH": path, "TMPDIR": folder},
            )  # fmt: skip
            try:
                code = child.wait(max(budget, repeats * LONG) + LOADING)
            except subprocess.TimeoutExpired:
                os.killpg(child.pid, signal.SIGKILL)
                child.wait()
                return MeasuredRun(setting, "over budget", f"killed; the budget is {budget:g} s")
            if not result.exists():
                output.seek(0)
                return MeasuredRun(setting, "crashed", _symptom(code, output.read()))
        found: dict[str, Any] = json.loads(result.read_text(encoding="utf-8"))
    return MeasuredRun(setting, **found)


def _symptom(code: int, output: bytes) -> str:
    """How a process without a result ended, and its last line of output."""
    lines = output.decode(errors="replace").strip().splitlines()
    last = lines[-1][:160] if lines else "no output"
    if code < 0:
        return f"{signal.Signals(-code).name}: {last}"
    return f"exit code {code}: {last}"
