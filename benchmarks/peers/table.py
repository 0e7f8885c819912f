"""Rungs as tables for the eye and a file for spreadsheets."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from rich.table import Table

from .figures import TARGET, Cost, cost
from .rung import Rung

Curve = tuple[str, str, str]
OURS: Curve = ("ours", "gauss-seidel", "ports")


def curves(rungs: Sequence[Rung]) -> dict[Curve, list[Rung]]:
    """Rungs of each tool, method and wiring, coarse to fine."""
    found: dict[Curve, list[Rung]] = {}
    for rung in rungs:
        found.setdefault(rung.setting.curve, []).append(rung)
    return found


def costs(rungs: Sequence[Rung]) -> dict[Curve, Cost]:
    return {curve: cost(line) for curve, line in curves(rungs).items()}


def rung_table(title: str, rungs: Sequence[Rung]) -> Table:
    """Every rung, those too that did not come to an end."""
    made = Table(title=title, title_justify="left")
    for label in ("tool", "version", "method", "wiring", "steps/cycle or rtol", "error", "order",
                  "wall s", "doStep calls", "stroke deg", ""):  # fmt: skip
        made.add_column(label, justify="right" if label in RIGHT else "left")
    for rung in rungs:
        setting = rung.setting
        made.add_row(
            setting.tool, rung.version, setting.method, setting.wiring, f"{setting.place:g}",
            *(_number(rung.error, ".2e"), _number(rung.order, ".2f"), _number(rung.wall, ".4f")),
            *(str(rung.calls or ""), _number(rung.stroke, ".3f")),
            "" if rung.status == "done" else f"{rung.status}: {rung.reason}",
        )  # fmt: skip
    return made


RIGHT = {"steps/cycle or rtol", "error", "order", "wall s", "doStep calls", "stroke deg"}


def cost_table(rungs: Sequence[Rung]) -> Table:
    """Time to the target of each curve, and how many times ours."""
    found = costs(rungs)
    own = found.get(OURS)
    made = Table(title=f"time to an error of {TARGET:g}; ~ extrapolated", title_justify="left")
    for label in ("tool", "method", "wiring", "time s", "times ours"):
        made.add_column(label, justify="right" if label.startswith("time") else "left")
    order = sorted(found, key=lambda c: (not isfinite(found[c].seconds), found[c].seconds))
    for curve in order:
        made.add_row(*curve, str(found[curve]), ratio(found[curve], own))
    return made


def ratio(one: Cost, own: Cost | None) -> str:
    """A time over ours, of the same run of the benchmark."""
    if own is None or not (isfinite(one.seconds) and isfinite(own.seconds)):
        return ""
    return f"{'' if one.sure and own.sure else '~ '}{one.seconds / own.seconds:.3g}"


def write(scene: str, rungs: Sequence[Rung], path: Path) -> None:
    """One line for each rung."""
    found = costs(rungs)
    own = found.get(OURS)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["scene", "tool", "version", "method", "wiring", "steps_per_cycle", "rtol", "status",
             "reason", "error", "order", "wall_s", "dostep_calls", "stroke_deg", "travel_m",
             "frequency_hz", "time_to_target_s", "extrapolated", "times_ours"]
        )  # fmt: skip
        for r in rungs:
            s, reached = r.setting, found[r.setting.curve]
            by_steps = s.ladder == "steps"
            writer.writerow(
                [scene, s.tool, r.version, s.method, s.wiring, s.place if by_steps else "",
                 "" if by_steps else s.place, r.status, r.reason, r.error, r.order, r.wall, r.calls,
                 r.stroke, r.travel, r.frequency, reached.seconds, not reached.sure,
                 ratio(reached, own).removeprefix("~ ")]
            )  # fmt: skip


def _number(value: float, form: str) -> str:
    return format(value, form) if isfinite(value) else ""
