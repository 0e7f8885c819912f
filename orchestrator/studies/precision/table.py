"""A precision study as a table, a CSV file, a log-log plot, and its cheapest settings."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import printable
from ...report.image import plain, save_figure, standard_settings
from ..output_files import write_records
from .method import Method
from .study import TARGETS, MeasuredRun, Study

if TYPE_CHECKING:
    from rich.table import Table

MARKERS = "osd^v<>p*"
LINES = ("-", "--", ":", "-.", (0, (1, 3)), (0, (6, 2, 1, 2, 1, 2)))


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


def _styles(methods: Sequence[Method]) -> Iterator[dict[str, Any]]:
    """A colour and a marker for each master, a line for each way to use it; none comes twice."""
    kinds = list(dict.fromkeys(method.kind for method in methods))
    ways = list(dict.fromkeys((m.laws, m.controlled, m.scenario) for m in methods))
    for method in methods:
        kind = kinds.index(method.kind)
        way = ways.index((method.laws, method.controlled, method.scenario))
        yield {
            "color": f"C{kind % 10}",
            "marker": MARKERS[kind % len(MARKERS)],
            "linestyle": LINES[way % len(LINES)],
            "fillstyle": "full" if way < len(LINES) else "none",
            "lw": 1.2,
            "ms": 4,
        }


@standard_settings()
def draw(study: Study, path: Path) -> Path:
    """Draw error over wall time and over the step, a curve for each method, failures at the top."""
    from matplotlib import pyplot

    methods = list(dict.fromkeys(measured.method for measured in study.runs))
    height = 7.4 + 0.2 * len(methods)
    figure, axes = pyplot.subplots(2, 1, figsize=(5.6, height), layout="constrained")
    for method, style in zip(methods, _styles(methods), strict=True):
        runs = [r for r in study.runs if r.method == method]
        done = [r for r in runs if r.status == "done" and study.error(r) > 0.0]
        errors = [study.error(r) for r in done]
        axes[0].loglog([r.wall_time for r in done], errors, label=str(method), **style)
        axes[1].loglog([study.simulated / max(r.steps, 1) for r in done], errors, **style)
        failed = [r.step for r in runs if r.status != "done"]
        axes[1].plot(failed, [1.0] * len(failed), "x", color=style["color"])
    axes[0].set(xlabel="wall time (s)")
    axes[1].set(xlabel="mean communication step (s); x: stopped")
    for axis in axes:
        axis.set(ylabel="largest error of the leading variables")
        axis.grid(visible=True, which="both", alpha=0.2)
    floor = max((study.bound.get(name, 0.0) for name in study.variables), default=0.0)
    if floor > 0.0:
        axes[1].axhline(floor, color="k", ls=":", lw=0.8)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", fontsize=9)
    title = textwrap.wrap(plain(study.title), 60) + textwrap.wrap(
        plain(f"leading: {', '.join(study.variables)}"), 60
    )
    figure.suptitle("\n".join(title), fontsize=10)
    try:
        return save_figure(figure, path, 120)
    finally:
        pyplot.close(figure)
