"""Runs as tables on the terminal and a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from rich.table import Table

from .figures import TARGET, Cost, cost
from .measured_run import MeasuredRun

Curve = tuple[str, str, str]
OURS: Curve = ("ours", "gauss-seidel", "ports")


def curves(runs: Sequence[MeasuredRun]) -> dict[Curve, list[MeasuredRun]]:
    """Runs of each tool, method and wiring, coarse to fine."""
    found: dict[Curve, list[MeasuredRun]] = {}
    for measured in runs:
        found.setdefault(measured.setting.curve, []).append(measured)
    return found


def costs(runs: Sequence[MeasuredRun]) -> dict[Curve, Cost]:
    return {curve: cost(line) for curve, line in curves(runs).items()}


def run_table(title: str, runs: Sequence[MeasuredRun]) -> Table:
    """Every run, also those that did not reach their end."""
    made = Table(title=title, title_justify="left")
    for label in ("tool", "version", "method", "wiring", "steps/cycle or rtol", "error", "order",
                  "wall s", "doStep calls", "stroke deg", ""):  # fmt: skip
        made.add_column(label, justify="right" if label in RIGHT else "left")
    for measured in runs:
        setting = measured.setting
        made.add_row(
            setting.tool, measured.version, setting.method, setting.wiring, f"{setting.place:g}",
            _number(measured.error, ".2e"),
            _number(measured.order, ".2f"),
            _number(measured.wall, ".4f"),
            *(str(measured.calls or ""), _number(measured.stroke, ".3f")),
            "" if measured.status == "done" else f"{measured.status}: {measured.reason}",
        )  # fmt: skip
    return made


RIGHT = {"steps/cycle or rtol", "error", "order", "wall s", "doStep calls", "stroke deg"}


def cost_table(runs: Sequence[MeasuredRun]) -> Table:
    """Time to the target of each curve, also as a multiple of ours."""
    found = costs(runs)
    own = found.get(OURS)
    made = Table(title=f"time to an error of {TARGET:g}; ~ extrapolated", title_justify="left")
    for label in ("tool", "method", "wiring", "time s", "times ours"):
        made.add_column(label, justify="right" if label.startswith("time") else "left")
    order = sorted(found, key=lambda c: (not isfinite(found[c].seconds), found[c].seconds))
    for curve in order:
        made.add_row(*curve, str(found[curve]), ratio(found[curve], own))
    return made


def ratio(one: Cost, own: Cost | None) -> str:
    """A time divided by ours, both from the same run of the benchmark."""
    if own is None or not (isfinite(one.seconds) and isfinite(own.seconds)):
        return ""
    return f"{'' if one.sure and own.sure else '~ '}{one.seconds / own.seconds:.3g}"


def write(scenario: str, runs: Sequence[MeasuredRun], path: Path) -> None:
    """One line for each run."""
    found = costs(runs)
    own = found.get(OURS)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["scenario", "tool", "version", "method", "wiring", "steps_per_cycle", "rtol", "status",
             "reason", "error", "order", "wall_s", "dostep_calls", "stroke_deg", "travel_m",
             "frequency_hz", "time_to_target_s", "extrapolated", "times_ours"]
        )  # fmt: skip
        for r in runs:
            s, reached = r.setting, found[r.setting.curve]
            by_steps = s.varied == "steps"
            writer.writerow(
                [scenario, s.tool, r.version, s.method, s.wiring, s.place if by_steps else "",
                 "" if by_steps else s.place, r.status, r.reason, r.error, r.order, r.wall, r.calls,
                 r.stroke, r.travel, r.frequency, reached.seconds, not reached.sure,
                 ratio(reached, own).removeprefix("~ ")]
            )  # fmt: skip


def _number(value: float, form: str) -> str:
    return format(value, form) if isfinite(value) else ""
