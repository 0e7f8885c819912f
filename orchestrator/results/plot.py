"""A picture of a run: what moved, what pushed, what it was fed, over the last cycles."""

from __future__ import annotations

import json
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, nearest
from ..report.image import save_figure
from ..units import UnitError, factor

if TYPE_CHECKING:
    import xarray

CYCLES = 5.0
MOST_POINTS = 20_000


def draw(
    data: xarray.Dataset, path: Path, patterns: list[str] | None = None, cycles: float = CYCLES
) -> Path:
    """Draw the last cycles, one panel for each kind of quantity, or for each unit of measure.

    With `patterns` the variables that match, grouped by their units; `InputError` where none
    does. `OutputError` where the picture cannot be written. `cycles` 0 draws everything.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    panels = _panels(data) if patterns is None else _chosen(data, patterns)
    time = np.asarray(data["time"].values)
    frequency = float(data.attrs.get("frequency", 0.0))
    first = 0
    if frequency > 0.0 and cycles > 0.0:
        first = int(np.searchsorted(time, time[-1] - cycles / frequency))
    shown = data.isel(time=slice(first, None, max(1, (len(time) - first) // MOST_POINTS)))
    figure, axes = pyplot.subplots(
        len(panels), 1, sharex=True, figsize=(8.0, 1.0 + 1.6 * len(panels)), squeeze=False
    )
    for axis, (label, scale, names) in zip(axes[:, 0], panels, strict=True):
        _panel(axis, shown, label, scale, names)
    axes[-1, 0].set_xlabel("Time (s)")
    figure.suptitle(str(data.attrs.get("title", "")).replace("$", r"\$"))
    figure.tight_layout()
    try:
        save_figure(figure, path, 110)
    finally:
        pyplot.close(figure)
    return path


def _panels(data: xarray.Dataset) -> list[tuple[str, float, list[str]]]:
    """The panels of the scenario's table `plot` as far as recorded; else the first variables."""
    names = [str(name) for name in data.data_vars]
    panels = []
    for label, text in _settings(data).items():
        patterns, _, unit = str(text).partition(" in ")
        shown = [n for n in names if any(fnmatchcase(n, p.strip()) for p in patterns.split(","))]
        if shown:
            own = str(data[shown[0]].attrs.get("units", ""))
            scale = _scale(own, unit.strip())
            panels.append((f"{label} ({unit.strip() or own})", scale, shown))
    return panels or [("value", 1.0, names[:4])]


def _settings(data: xarray.Dataset) -> dict[str, Any]:
    """The scenario's own table `plot`, as the result carries it."""
    try:
        known = json.loads(data.attrs["scenario"])["plot"]
    except (KeyError, ValueError, TypeError):
        return {}
    return known if isinstance(known, dict) else {}


def _scale(own: str, wanted: str) -> float:
    try:
        return factor(own, wanted) if own and wanted else 1.0
    except UnitError:
        return 1.0


def _chosen(data: xarray.Dataset, patterns: list[str]) -> list[tuple[str, float, list[str]]]:
    """Variables that match, by unit."""
    names = [str(name) for name in data.data_vars]
    panels: dict[str, list[str]] = {}
    for pattern in patterns:
        matching = [name for name in names if fnmatchcase(name, pattern)]
        if not matching:
            raise InputError(
                f"--variable {pattern!r}: not in the result; {nearest(pattern, names)}"
            )
        for name in matching:
            group = panels.setdefault(str(data[name].attrs.get("units", "")), [])
            if name not in group:
                group.append(name)
    return [(unit, 1.0, group) for unit, group in panels.items()]


def _panel(axis: Any, data: xarray.Dataset, label: str, scale: float, names: list[str]) -> None:
    time = np.asarray(data["time"].values)
    for name in names:
        axis.plot(time, scale * np.asarray(data[name].values), label=name, lw=1.2)
    axis.set_ylabel(label, fontsize=8)
    axis.grid(visible=True, alpha=0.3)
    if len(names) > 1:
        axis.legend(fontsize=7, loc="upper right")
