"""A precision study as a table, a CSV file, a log-log plot, and its cheapest settings."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import printable
from ...report.image import plain, save_figure, standard_settings
from ..output_files import write_records
from .study import TARGETS, MeasuredRun, Study

if TYPE_CHECKING:
    from rich.table import Table

MARKERS = "osd^v<>p*"


def per_cycle(study: Study, measured: MeasuredRun) -> str:
    """The step of a run as steps per cycle, else as a time; or its tolerance."""
    if measured.tolerance is not None:
        return f"{measured.tolerance:.0e} tolerance"
    if study.frequency:
        return f"{1.0 / study.frequency / measured.step:.4g} per cycle"
    return f"{measured.step:.4g} s"


def table(study: Study) -> Table:
    """Every run: setting, error, order and cost, or why it stopped."""
    from rich.table import Table

    made = Table(title=printable(study.title), title_justify="left")
    for label in ("method", "step", "error", "order", "wall time", "doStep calls", "rollbacks", ""):
        made.add_column(label)
    for measured in study.runs:
        done = measured.status == "done"
        made.add_row(
            str(measured.method),
            per_cycle(study, measured),
            f"{study.error(measured):.2e}" if done else "-",
            "" if math.isnan(measured.order) else f"{measured.order:.2f}",
            f"{measured.wall_time:.3f} s" if done else "-",
            str(measured.calls),
            str(measured.rollbacks),
            "" if done else printable(measured.status, most=80),
        )
    return made


def cheapest_settings(study: Study) -> Iterator[str]:
    """A line for each of the usual errors: the cheapest setting that reaches it."""
    for target in TARGETS:
        measured = study.cheapest(target)
        if measured is None:
            yield f"{target:.0e}: not reached"
            continue
        speed = study.simulated / measured.wall_time
        yield (
            f"{target:.0e}: {measured.method}, {per_cycle(study, measured)}:"
            f" {study.error(measured):.1e},"
            f" {speed:.1f} times real time"
        )


def facts(study: Study) -> list[dict[str, Any]]:
    """One record for each run and variable."""
    records = []
    for measured in study.runs:
        setting = {
            "master": measured.method.kind,
            "laws": measured.method.laws,
            "scenario": measured.method.scenario,
            "step": measured.step,
            "tolerance": measured.tolerance,
            "status": measured.status,
            "wall_time": measured.wall_time,
            "communication_steps": measured.steps,
            "step_calls": measured.calls,
            "rollbacks": measured.rollbacks,
            "order": measured.order,
        }
        for name in measured.largest or {"": 0.0}:
            errors = {
                "largest": measured.largest.get(name),
                "rms": measured.rms.get(name),
            }
            records.append({**setting, "variable": name, **errors})
    return records


def write(study: Study, path: Path) -> Path:
    """Write all records as CSV; a text that a spreadsheet would compute is quoted."""
    return write_records(facts(study), path)


@standard_settings()
def draw(study: Study, path: Path) -> Path:
    """Draw error over wall time and over the step, a curve for each method, failures at the top."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 2, sharey=True, figsize=(10.0, 5.0))
    methods = list(dict.fromkeys(measured.method for measured in study.runs))
    for k, method in enumerate(methods):
        runs = [r for r in study.runs if r.method == method]
        done = [r for r in runs if r.status == "done" and study.error(r) > 0.0]
        style = {"marker": MARKERS[k % len(MARKERS)], "color": f"C{k % 10}", "lw": 1.0, "ms": 4}
        errors = [study.error(r) for r in done]
        axes[0].loglog([r.wall_time for r in done], errors, label=str(method), **style)
        axes[1].loglog([study.simulated / max(r.steps, 1) for r in done], errors, **style)
        failed = [r.step for r in runs if r.status != "done"]
        axes[1].plot(failed, [1.0] * len(failed), "x", color=style["color"])
    axes[0].set(xlabel="wall time (s)", ylabel=f"largest error of {', '.join(study.variables)}")
    axes[1].set(xlabel="mean communication step (s); x: stopped")
    for axis in axes:
        axis.grid(visible=True, which="both", alpha=0.2)
    floor = max((study.bound.get(name, 0.0) for name in study.variables), default=0.0)
    if floor > 0.0:
        axes[1].axhline(floor, color="k", ls=":", lw=0.8)
    axes[0].legend(fontsize=7)
    figure.suptitle(plain(study.title), fontsize=10)
    figure.set_layout_engine("tight")
    try:
        return save_figure(figure, path, 120)
    finally:
        pyplot.close(figure)
