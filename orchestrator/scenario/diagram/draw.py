"""A checked scenario as a drawing: components from top to bottom in execution order, and wires.

Wires that run with the execution order are on the right, those against it on the left.
Neighbours are joined directly, in the gap between their boxes; any other wire leaves at the
side and runs in a track of its own. Labels are only in gaps and wires enter only at boxes,
so that no label can lie on a box or on another label. Lengths are in inches, y downwards.
"""

from __future__ import annotations

import warnings
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import OutputError
from ...report.files import written_whole
from ..plan import Plan

if TYPE_CHECKING:
    from matplotlib.axes import Axes
from .layout import BADGE, EDGE, FACE, SETTINGS, Line, Sheet, layout

DPI = 150


def draw(plan: Plan, path: Path) -> Path:
    """Write an SVG, or a PNG where the file is named so; the same scenario gives the same bytes."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    kind = path.suffix.lower()
    if kind not in {".svg", ".png"}:
        raise OutputError(f"{path}: a diagram is an SVG or a PNG; name it *.svg or *.png")
    with matplotlib.rc_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(SETTINGS)
        sheet = layout(plan)
        left, right, top, bottom = sheet.extent
        figure = Figure(figsize=(right - left, bottom - top), dpi=DPI)
        canvas = FigureCanvasSVG(figure) if kind == ".svg" else FigureCanvasAgg(figure)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(left, right), ylim=(bottom, top))
        axes.set_axis_off()
        _paint(axes, sheet)
        drawn = BytesIO()
        metadata = {"Date": None} if kind == ".svg" else None
        with written_whole(path, failures=(ValueError,)) as waiting:
            canvas.print_figure(drawn, format=kind[1:], dpi=DPI, metadata=metadata)
            waiting.write_bytes(drawn.getvalue())
    return path


def _paint(axes: Axes, sheet: Sheet) -> None:
    """Draw lines below boxes below texts; no text is taken for mathematics."""
    from matplotlib.patches import Circle, FancyBboxPatch

    for line in sheet.lines:
        axes.add_patch(_arrow(line))
    for box in sheet.boxes:
        corner, style = (-box.width / 2.0, box.top), "round,pad=0.0,rounding_size=0.1"
        colours: dict[str, Any] = {"facecolor": FACE, "edgecolor": EDGE, "linewidth": 1.3}
        axes.add_patch(FancyBboxPatch(corner, box.width, box.height, style, zorder=2.0, **colours))
    for badge in sheet.badges:
        axes.add_patch(Circle((badge.x, badge.y), BADGE, color=EDGE, linewidth=0.0, zorder=3.0))
    for text in (*sheet.badges, *sheet.texts):
        axes.text(
            text.x, text.y, text.text, fontsize=text.size, ha=text.align, color=text.colour,
            va="center_baseline", fontweight="bold" if text.bold else "normal", zorder=4.0,
            parse_math=False,
        )  # fmt: skip


def _arrow(line: Line) -> Any:
    """Patch of a line with its head."""
    from matplotlib.patches import FancyArrowPatch

    shape: dict[str, Any] = {"path": _rounded(line.points)}
    if len(line.points) == 2:
        shape = dict(zip(("posA", "posB"), line.points, strict=True))
        shape["connectionstyle"] = f"arc3,rad={line.bend}"
    shape |= {"shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 7.0 + 3.0 * line.thick}
    return FancyArrowPatch(
        **shape, arrowstyle="-|>", color=line.colour, linewidth=line.thick, zorder=1.0
    )


def _rounded(points: tuple[tuple[float, float], ...], radius: float = 0.1) -> Any:
    """Path through corners, each cut off by a quarter turn."""
    from matplotlib.path import Path as Curve

    vertices, codes = [points[0]], [Curve.MOVETO]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        vertices += [_towards(corner, before, radius), corner, _towards(corner, after, radius)]
        codes += [Curve.LINETO, Curve.CURVE3, Curve.CURVE3]
    return Curve([*vertices, points[-1]], [*codes, Curve.LINETO])


def _towards(
    corner: tuple[float, float], end: tuple[float, float], radius: float
) -> tuple[float, float]:
    """Point at a distance from a corner, at most halfway to the next one."""
    dx, dy = end[0] - corner[0], end[1] - corner[1]
    length = max(abs(dx), abs(dy))
    share = min(radius / length, 0.5) if length else 0.0
    return corner[0] + share * dx, corner[1] + share * dy
