"""What `resilin compare` shows of two sweeps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

from ..errors import printable
from ..studies.sweep.comparison import MetricDifference, SweepComparison
from .compared_runs import difference_facts

if TYPE_CHECKING:
    from rich.table import Table

MOST_VALUES = 8
"""Values of an axis that a line lists."""


def table(found: SweepComparison, names: Sequence[str]) -> Table:
    """The differences of the metrics that both have, and the points at which they are largest."""
    from rich.table import Table

    points = f"{found.points} point" + "s" * (found.points != 1)
    one, other = map(printable, names)
    made = Table(title=f"{other} minus {one}, at {points}")
    made.add_column("metric", overflow="fold")
    for heading in ("largest", "relative", "rms"):
        made.add_column(heading, justify="right", no_wrap=True)
    axes = [f"{_words(name)}{_bracketed(found.units[name])}" for name in found.axes]
    made.add_column("\n".join(["at", *", ".join(axes).split()]), justify="right")
    for each in found.differences:
        made.add_row(
            printable(each.name),
            _size(each.largest, each),
            f"{each.relative:.2g}" if isfinite(each.relative) else "-",
            _size(each.rms, each),
            ", ".join(map(_text, each.at.values())) if each.largest > 0.0 else "-",
        )
    return made


def remarks(found: SweepComparison, names: Sequence[str]) -> Iterator[str]:
    """What only one of the two has, and metrics without a value somewhere."""
    for axis, alone in found.alone.items():
        for name, values in zip(names, alone, strict=True):
            if values:
                yield f"{printable(axis)} {_listed(values, found.units[axis])}: only in {name}"
    for each in found.differences:
        if each.points < found.points:
            yield (
                f"{printable(each.name)}: both have a value at {each.points} of"
                f" {found.points} points"
            )


def facts(found: SweepComparison) -> dict[str, Any]:
    """The comparison as data for scripts: values in SI."""
    return {
        "axes": {
            name: {"unit": found.units[name], "values": values}
            for name, values in found.axes.items()
        },
        "alone": found.alone,
        "differences": {
            each.name: {**difference_facts(each), "points": each.points}
            for each in found.differences
        },
    }


def _size(value: float, of: MetricDifference) -> str:
    unit, scale = of.shown_in
    return f"{scale * value:.3g} {printable(unit)}".strip() if isfinite(value) else "-"


def _listed(values: Sequence[float | str], unit: str) -> str:
    shown = [*map(_text, values[:MOST_VALUES]), *["..."] * (len(values) > MOST_VALUES)]
    return f"{', '.join(shown)} {printable(unit)}".strip()


def _text(value: float | str) -> str:
    return printable(value, most=40) if isinstance(value, str) else f"{value:.6g}"


def _words(name: str) -> str:
    """A name that may be broken between a component and its parameter."""
    return printable(name).replace(".", ". ")


def _bracketed(unit: str) -> str:
    return "" if unit in {"", "1"} else f" ({printable(unit)})"
