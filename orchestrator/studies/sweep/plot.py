"""A plot of a sweep: metrics as lines over one axis, as heat maps over two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from itertools import cycle
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError, nearest, printable
from ...report.image import plain, save_figure, standard_settings
from .comparison import check_same_axes, difference, in_unit_of, without_settings
from .table import SELECT, metric_names, shown_in

if TYPE_CHECKING:
    import xarray

RESOLUTION = 110
MOST_COLUMNS = 3
STYLES = ("-", "--", ":", "-.")
"""Lines of the sweeps that are drawn over each other."""
MARKED = 40
"""Most points of a line that are marked one by one."""


def draw(data: xarray.Dataset, path: Path, patterns: Sequence[str] | None = None) -> Path:
    """Draw the metrics that match, or all that vary, each in a panel of its own.

    Over one axis a metric is a line, over two axes of numbers a heat map, and over numbers and
    texts a line for each text. `InputError` where more than two axes have several values, or a
    pattern matches no metric; `OutputError` where the plot cannot be written.
    """
    return overlay({"": data}, path, patterns)


@standard_settings()
def overlay(
    sweeps: Mapping[str, xarray.Dataset], path: Path, patterns: Sequence[str] | None = None
) -> Path:
    """Draw sweeps over the same axes by their names, the lines of each in a kind of its own.

    In the place of two heat maps there is one, of the second sweep minus the first one. Metrics
    are those of the first sweep; the rest is as for :func:`draw`.
    """
    from matplotlib.figure import Figure

    known = dict(zip(sweeps, without_settings(sweeps.values()), strict=True))
    first = next(iter(known.values()))
    for data in known.values():
        check_same_axes(first, data)
    axes = [str(name) for name in first.dims]
    if not 1 <= len(axes) <= 2:
        listed = ", ".join(axes) or "no axis"
        raise InputError(f"{listed}: a plot shows one or two axes of several values; {SELECT}")
    axes.sort(key=lambda name: not _numeric(first[name]))
    maps = len(axes) == 2 and _numeric(first[axes[1]]) == _numeric(first[axes[0]])
    if maps and len(known) > 1:
        return draw(_difference(known), path, patterns)
    names = _chosen(first, patterns)
    columns = min(MOST_COLUMNS, ceil(len(names) / 2))
    rows = ceil(len(names) / columns)
    size = (1.0 + 5.0 * columns, 1.0 + (3.6 if maps else 2.4) * rows)
    figure = Figure(figsize=size, layout="constrained")
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for unused in panels[len(names) :]:
        unused.remove()
    for panel, name in zip(panels, names, strict=False):
        unit, scale = shown_in(first[name])
        label = _plain(f"{name} ({unit})" if unit else name)
        if maps:
            _heat_map(
                figure, panel, first, axes, scale * first[name].transpose(*axes).values, label
            )
        else:
            _lines(panel, known, axes, name, scale)
            panel.set_ylabel(label, fontsize=8)
        panel.set_xlabel(_labelled(first[axes[0]]), fontsize=8)
    figure.suptitle(_plain(str(first.attrs.get("title", ""))), fontsize=11)
    return save_figure(figure, path, RESOLUTION)


def _chosen(data: xarray.Dataset, patterns: Sequence[str] | None) -> list[str]:
    """Metrics that match a pattern; without patterns those that vary, or all if none does."""
    names = [name for name in metric_names(data) if np.isfinite(data[name].values).any()]
    if not names:
        raise InputError("no point of the sweep has a metric; its reasons are in `reason`")
    if not patterns:
        return [name for name in names if np.nanstd(data[name].values) > 0.0] or names
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in names):
            raise InputError(
                f"--variable {printable(pattern)!r}: no such metric; {nearest(pattern, names)}"
            )
    return [name for name in names if any(fnmatchcase(name, p) for p in patterns)]


def _difference(sweeps: Mapping[str, xarray.Dataset]) -> xarray.Dataset:
    """The second of two sweeps minus the first one, entitled so."""
    if len(sweeps) > 2:
        raise InputError(
            f"{len(sweeps)} sweeps over two axes: their heat maps do not go over each other; give"
            " two, of which the difference is drawn, or one"
        )
    one, other = sweeps
    return difference(*sweeps.values()).assign_attrs(title=f"{other} minus {one}")


def _lines(
    panel: Any, sweeps: Mapping[str, xarray.Dataset], axes: Sequence[str], name: str, scale: float
) -> None:
    """A colour for each sweep, or for each value of the second axis, a kind of line for each."""
    first = next(iter(sweeps.values()))
    beside = axes[1:]
    texts = [str(v) for data in sweeps.values() for a in beside for v in data[a].values]
    colours = list(dict.fromkeys(texts or sweeps))
    for style, (sweep, data) in zip(cycle(STYLES), sweeps.items()):
        if name not in data:
            continue
        places = _ticks(data[axes[0]])
        if _numeric(data[axes[0]]):
            places = in_unit_of(first[axes[0]], data[axes[0]])
        values = scale * in_unit_of(first[name], data[name].transpose(*axes))
        marker = "o" if len(places) <= MARKED else ""
        for k, line in enumerate(values.reshape(len(places), -1).T):
            text = [str(data[axis].values[k]) for axis in beside]
            panel.plot(
                places, line, style, marker=marker, ms=3, lw=1.2,
                label=_plain(", ".join([*text, *filter(None, [sweep])])),
                color=f"C{colours.index((text or [sweep])[0]) % 10}",
            )  # fmt: skip
        _mark_peak(panel, data, name, scale)
    panel.grid(visible=True, alpha=0.3)
    if texts or len(sweeps) > 1:
        panel.legend(fontsize=7, title=_plain(", ".join(beside)), title_fontsize=7)


def _heat_map(
    figure: Any, panel: Any, data: xarray.Dataset, axes: Sequence[str], values: Any, label: str
) -> None:
    """Values by colour; a point without one stays white."""
    numbers = [
        data[name].values if _numeric(data[name]) else np.arange(data.sizes[name]) for name in axes
    ]
    shown = panel.pcolormesh(*numbers, np.ma.masked_invalid(values.T), shading="nearest")
    if not _numeric(data[axes[0]]):
        panel.set_xticks(numbers[0], _ticks(data[axes[0]]))
        panel.set_yticks(numbers[1], _ticks(data[axes[1]]))
    figure.colorbar(shown, ax=panel, label=label)
    panel.set_ylabel(_labelled(data[axes[1]]), fontsize=8)


def _mark_peak(panel: Any, data: xarray.Dataset, name: str, scale: float) -> None:
    """The refined peak with its uncertainty, where this metric was refined."""
    known = data.attrs
    if known.get("refined") != data[name].attrs.get("long_name") or "peak_uncertainty" not in known:
        return
    panel.errorbar(
        known["peak_at"], scale * known["peak"], scale * known["peak_uncertainty"],
        known["peak_at_uncertainty"], fmt="k+", ms=9, lw=1.0, label="peak",
    )  # fmt: skip
    panel.legend(fontsize=7)


def _numeric(axis: xarray.DataArray) -> bool:
    return bool(np.issubdtype(axis.dtype, np.number))


def _ticks(axis: xarray.DataArray) -> Any:
    return axis.values if _numeric(axis) else [_plain(str(value)) for value in axis.values]


def _labelled(axis: xarray.DataArray) -> str:
    unit = str(axis.attrs.get("units", ""))
    return _plain(f"{axis.name} ({unit})" if unit not in {"", "1"} else str(axis.name))


def _plain(text: str) -> str:
    return plain(text, most=80)
