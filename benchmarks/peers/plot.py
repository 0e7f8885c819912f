"""All curves in one log-log plot of error over wall time."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from .figures import TARGET
from .measured_run import MeasuredRun
from .table import curves

MARKERS = "osd^v<>p*hX"
LINES = {"ports": "-", "values": "--", "one ODE": ":"}


def draw(scenario: str, runs: Sequence[MeasuredRun], path: Path) -> None:
    """A colour for each tool, a marker for each method, a line style for each wiring."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axis = pyplot.subplots(figsize=(9.0, 6.0))
    tools = list(dict.fromkeys(measured.setting.tool for measured in runs))
    methods = list(dict.fromkeys(r.setting.curve[:2] for r in runs))
    for curve, line in curves(runs).items():
        done = [r for r in line if r.status == "done" and isfinite(r.error) and r.error > 0.0]
        if not done:
            continue
        tool, method, wiring = curve
        axis.loglog(
            [r.wall for r in done], [r.error for r in done], LINES[wiring],
            color=f"C{tools.index(tool)}", lw=2.0 if tool == "ours" else 1.0, ms=4,
            marker=MARKERS[methods.index((tool, method)) % len(MARKERS)],
            label=", ".join(curve),
        )  # fmt: skip
    axis.axhline(TARGET, color="k", lw=0.6)
    axis.set(xlabel="wall time (s)", ylabel="largest error of the motion over its largest value")
    axis.set_title(scenario, fontsize=10)
    axis.set_ylim(top=10.0)
    axis.grid(visible=True, which="both", alpha=0.2)
    axis.legend(fontsize=6, loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.savefig(path, bbox_inches="tight")
    pyplot.close(figure)
