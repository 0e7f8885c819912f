"""A plot of a run: the variables that its scenario names, over the last cycles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fnmatch import fnmatchcase
from itertools import cycle
from math import inf
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, nearest
from ..report.image import plain, save_figure, standard_settings
from ..units import UnitError, factor
from .outcome import Outcome
from .recorded import Recorded, recorded

if TYPE_CHECKING:
    import xarray

CYCLES = 5.0
MOST_POINTS = 20_000
MOST_ON_PAGE = 2000
"""Points of a curve on a page: more than a screen has columns."""
WIDTH = 90
"""Characters of a line above a plot."""
STYLES = ("-", "--", ":", "-.")
"""Lines of the runs that are drawn over each other."""


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
    return overlay({"": recorded(source)}, path, patterns, cycles)


@standard_settings()
def overlay(
    runs: Mapping[str, Recorded],
    path: Path,
    patterns: list[str] | None = None,
    cycles: float = CYCLES,
) -> Path:
    """Draw the same variables of several runs over each other, by the names of the runs.

    The panels are those of the first one; a variable has one colour, a run one kind of line. All
    end where the first of them ends. The rest is as for :func:`draw`.
    """
    from matplotlib.figure import Figure

    first = next(iter(runs.values()))
    units = {
        name: unit for data in reversed(list(runs.values())) for name, unit in data.units.items()
    }
    texts = [name for data in runs.values() for name in data.texts]
    for pattern in patterns or ():
        if pattern in texts:
            raise InputError(f"--variable {pattern!r}: is a text, of which there is no curve")
    if not units:
        raise InputError("no variable was recorded, so there is nothing to draw")
    panels = _chosen(units, patterns) if patterns else _panels(units, first.plot or {})
    begin, end = _span(runs.values(), cycles)
    figure = Figure(figsize=(9.0, 1.0 + 1.6 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)
    for axis, (label, unit, names) in zip(axes[:, 0], panels, strict=True):
        for style, (run, data) in zip(cycle(STYLES), runs.items()):
            shown = _shown(data.times, begin, end)
            _curves(axis, run, data, shown, unit, names, style)
        axis.set_ylabel(plain(label), fontsize=8)
        axis.grid(visible=True, alpha=0.3)
        if len(names) * len(runs) > 1:
            axis.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes[-1, 0].set_xlabel("Time (s)")
    figure.suptitle("\n".join(map(plain, _headings(runs))))
    return save_figure(figure, path, 110)


def _headings(runs: Mapping[str, Recorded]) -> Iterator[str]:
    """Titles, what was changed against the scenario, and which runs are not to be used."""
    if len(runs) > 1:
        yield ", ".join(runs)
    for name, run in runs.items():
        of = f"{name}: " if len(runs) > 1 else ""
        if not of:
            yield run.title
            if run.notes.changed:
                yield from wrap(f"with {run.notes.changed}", WIDTH)
        if run.notes.verdict:
            yield from wrap(f"NOT TO BE USED: {of}{run.notes.verdict}", WIDTH)


def panels_of(
    data: Recorded, cycles: float = CYCLES, most: int = MOST_ON_PAGE
) -> list[tuple[str, list[tuple[str, NDArray[np.float64], NDArray[np.float64]]]]]:
    """Label and curves (name, times [s], values in the panel's unit) of a scenario's panels.

    Over the last cycles, as :func:`draw`; of longer series at most `most` points.
    """
    if not data.units or not len(data.times):
        return []
    begin, end = _span([data], cycles)
    first, last = (int(k) for k in np.searchsorted(data.times, [begin, end]))
    shown = slice(first, last + 1, max(1, (last + 1 - first) // most))
    return [
        (
            label,
            [
                (name, data.times[shown], _scale(data.units[name], unit) * data.series[name][shown])
                for name in names
            ],
        )
        for label, unit, names in _panels(data.units, data.plot or {})
    ]


def _span(runs: Iterable[Recorded], cycles: float) -> tuple[float, float]:
    """Begin and end of what is drawn [s]: the last cycles of the slowest run that all have."""
    known = list(runs)
    end = min(float(data.times[-1]) for data in known)
    slowest = min(data.frequency for data in known)
    return (end - cycles / slowest if slowest > 0.0 and cycles > 0.0 else -inf), end


def _shown(times: NDArray[np.float64], begin: float, end: float) -> slice:
    first, last = (int(k) for k in np.searchsorted(times, [begin, end]))
    return slice(first, last + 1, max(1, (last + 1 - first) // MOST_POINTS))


def _panels(
    units: Mapping[str, str], wanted: Mapping[str, Any]
) -> list[tuple[str, str, list[str]]]:
    """The panels of a scenario's table `plot` as far as recorded; else the first variables."""
    panels = []
    for label, text in wanted.items():
        patterns, _, unit = str(text).partition(" in ")
        shown = [n for n in units if any(fnmatchcase(n, p.strip()) for p in patterns.split(","))]
        if shown:
            common = unit.strip() or units[shown[0]]
            panels.append((f"{label} ({common})", common, shown))
    return panels or [("value", "", list(units)[:4])]


def _scale(own: str, wanted: str) -> float:
    try:
        return factor(own, wanted) if own and wanted else 1.0
    except UnitError:
        return 1.0


def _chosen(units: Mapping[str, str], patterns: list[str]) -> list[tuple[str, str, list[str]]]:
    """Variables that match, by unit."""
    panels: dict[str, list[str]] = {}
    for pattern in patterns:
        matching = [name for name in units if fnmatchcase(name, pattern)]
        if not matching:
            raise InputError(
                f"--variable {pattern!r}: not in the result; {nearest(pattern, units)}"
            )
        for name in matching:
            group = panels.setdefault(units[name], [])
            if name not in group:
                group.append(name)
    return [(unit, unit, group) for unit, group in panels.items()]


def _curves(
    axis: Any, run: str, data: Recorded, shown: slice, unit: str, names: list[str], style: str
) -> None:
    """The variables of a panel that a run has."""
    for k, name in enumerate(names):
        if name not in data.series:
            continue
        values = _scale(data.units[name], unit) * data.series[name][shown]
        label = plain(f"{name}, {run}" if run else name)
        axis.plot(data.times[shown], values, style, color=f"C{k % 10}", label=label, lw=1.2)
