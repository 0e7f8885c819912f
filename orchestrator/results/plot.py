"""A plot of a run: the variables that its scenario names, over the last cycles."""

from __future__ import annotations

from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, nearest
from ..report.image import plain, save_figure, standard_settings
from ..units import UnitError, factor
from .outcome import Outcome
from .recorded import Recorded, recorded

if TYPE_CHECKING:
    import xarray

CYCLES = 5.0
MOST_POINTS = 20_000


@standard_settings()
def draw(
    source: Recorded | Outcome | xarray.Dataset,
    path: Path,
    patterns: list[str] | None = None,
    cycles: float = CYCLES,
) -> Path:
    """Draw the last cycles, one panel for each of the scenario's table `plot`.

    With `patterns` the variables that match, one panel for each unit; `InputError` where none
    does. `OutputError` where the plot cannot be written. `cycles` 0 draws everything.
    """
    from matplotlib.figure import Figure

    data = recorded(source)
    panels = _panels(data) if patterns is None else _chosen(data, patterns)
    time, first = data.times, 0
    if data.frequency > 0.0 and cycles > 0.0:
        first = int(np.searchsorted(time, time[-1] - cycles / data.frequency))
    shown = slice(first, None, max(1, (len(time) - first) // MOST_POINTS))
    figure = Figure(figsize=(8.0, 1.0 + 1.6 * len(panels)))
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)
    for axis, (label, scale, names) in zip(axes[:, 0], panels, strict=True):
        _panel(axis, data, shown, label, scale, names)
    axes[-1, 0].set_xlabel("Time (s)")
    figure.suptitle(plain(data.title))
    figure.set_layout_engine("tight")
    return save_figure(figure, path, 110)


def _panels(data: Recorded) -> list[tuple[str, float, list[str]]]:
    """The panels of the scenario's table `plot` as far as recorded; else the first variables."""
    names = list(data.series)
    panels = []
    for label, text in (data.plot or {}).items():
        patterns, _, unit = str(text).partition(" in ")
        shown = [n for n in names if any(fnmatchcase(n, p.strip()) for p in patterns.split(","))]
        if shown:
            own = data.units[shown[0]]
            scale = _scale(own, unit.strip())
            panels.append((f"{label} ({unit.strip() or own})", scale, shown))
    return panels or [("value", 1.0, names[:4])]


def _scale(own: str, wanted: str) -> float:
    try:
        return factor(own, wanted) if own and wanted else 1.0
    except UnitError:
        return 1.0


def _chosen(data: Recorded, patterns: list[str]) -> list[tuple[str, float, list[str]]]:
    """Variables that match, by unit."""
    names = list(data.series)
    panels: dict[str, list[str]] = {}
    for pattern in patterns:
        matching = [name for name in names if fnmatchcase(name, pattern)]
        if not matching:
            raise InputError(
                f"--variable {pattern!r}: not in the result; {nearest(pattern, names)}"
            )
        for name in matching:
            group = panels.setdefault(data.units[name], [])
            if name not in group:
                group.append(name)
    return [(unit, 1.0, group) for unit, group in panels.items()]


def _panel(
    axis: Any, data: Recorded, shown: slice, label: str, scale: float, names: list[str]
) -> None:
    for name in names:
        axis.plot(data.times[shown], scale * data.series[name][shown], label=plain(name), lw=1.2)
    axis.set_ylabel(plain(label), fontsize=8)
    axis.grid(visible=True, alpha=0.3)
    if len(names) > 1:
        axis.legend(fontsize=7, loc="upper right")
