"""A figure of a page as a file of its own: PNG, SVG or another format of matplotlib."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import printable
from .files import check_place, written_whole
from .plot import Axis, Figure, Plot

STYLES = {"line": "-", "dashed": "--", "points": "None", "line-points": "-", "stated": "None"}
MARKERS = "osd^v<>P"
ENDINGS = (".png", ".svg", ".pdf")


def check_plot(path: Path, kind: str = "plots are pictures") -> None:
    """Check that a plot can be written to `path`, before any work is done for it."""
    check_place(path, kind, ENDINGS)


@contextmanager
def standard_settings() -> Iterator[None]:
    """matplotlib's own settings, whatever a matplotlibrc in the current folder says."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.use("Agg")
        yield


def save_figure(
    figure: Any, path: Path, resolution: int, metadata: Mapping[str, Any] | None = None
) -> Path:
    """Save a matplotlib figure in the format that its path names, `resolution` in dots per inch.

    Raises `OutputError` where the path cannot be written or does not name a format, and where
    matplotlib cannot draw what it was given.
    """
    with written_whole(path, failures=(Exception,)) as waiting:
        figure.savefig(waiting, format=path.suffix[1:].lower(), dpi=resolution, metadata=metadata)
    return path


@standard_settings()
def draw(figure: Figure, paths: Sequence[Path]) -> list[Path]:
    """Draw the plots one below the other into each of the files."""
    import matplotlib
    from matplotlib import pyplot

    sheet, axes = pyplot.subplots(
        len(figure.plots), 1, figsize=(9.0, 0.6 + 3.1 * len(figure.plots)), squeeze=False,
        layout="constrained",
    )  # fmt: skip
    for axis, plot in zip(axes[:, 0], figure.plots, strict=True):
        _panel(axis, plot)
    sheet.suptitle(plain(figure.title), fontsize=10)
    sheet.align_ylabels(axes)
    try:
        for path in paths:
            with matplotlib.rc_context({"svg.hashsalt": figure.key}):
                save_figure(sheet, path, 130, metadata=_undated(path))
    finally:
        pyplot.close(sheet)
    return list(paths)


def _panel(axis: Any, plot: Plot) -> None:
    for k, curve in enumerate(plot.curves):
        marker = MARKERS[k % len(MARKERS)] if "points" in curve.style else ""
        colour = f"C{k % 10}"
        if curve.style == "stated":
            marker, colour = "x", "k"
        axis.plot(
            list(curve.x), list(curve.y), ls=STYLES[curve.style], label=plain(curve.name), lw=1.3,
            color=colour, marker=marker, ms=6 if curve.style == "stated" else 4,
        )  # fmt: skip
    axis.set_title(plain(plot.title), fontsize=9)
    _scaled(axis.set_xlabel, axis.set_xscale, axis.set_xlim, plot.x)
    _scaled(axis.set_ylabel, axis.set_yscale, axis.set_ylim, plot.y)
    axis.grid(visible=True, alpha=0.3)
    if len(plot.curves) > 1:
        axis.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _scaled(label: Any, scale: Any, limits: Any, axis: Axis) -> None:
    label(plain(axis.label))
    if axis.log:
        scale("log")
    if axis.least is not None or axis.most is not None:
        limits(axis.least, axis.most)


def plain(text: str, *, most: int = 200) -> str:
    """Foreign text, escaped, also the dollars between which matplotlib reads formulas."""
    return printable(text, most=most).replace("$", r"\$")


def _undated(path: Path) -> dict[str, Any]:
    return {"Date": None} if path.suffix == ".svg" else {}
