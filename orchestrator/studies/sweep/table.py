"""A sweep's dataset as rows: axes, metrics, and the status of each point."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import floor, isfinite, log10
from typing import TYPE_CHECKING, Any

from ...errors import printable
from ...results.metrics import shown
from ...results.scenario_attribute import scenario_table
from ...units import UnitError, factor
from .dataset import BESIDE

if TYPE_CHECKING:
    import xarray
    from rich.table import Table

LONGEST_WORD = 20
"""Characters of a heading before it is broken."""
NOTHING = "-"
DONE = "done"
SELECT = 'select with xarray, as data.sel({"component.parameter": value}), and write that to a file'
"""How a user takes an axis out of a sweep."""
FRAME = 3
"""Characters that a table puts around a column."""


def facts(data: xarray.Dataset) -> list[dict[str, Any]]:
    """One record for each point: axes, metrics in SI, status."""
    names = [str(name) for name in [*data.dims, *data.data_vars]]
    columns = [_values(data, name) for name in names]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


@dataclass(frozen=True)
class _Column:
    """A heading in lines, and the texts of all points, `NOTHING` where one has no value."""

    name: str
    unit: str
    texts: list[str]

    @property
    def varies(self) -> bool:
        return len(self._known) > 1

    @property
    def constant(self) -> str:
        """Name, value and unit of a column whose texts are all the same."""
        return f"{self.name} {next(iter(self._known), NOTHING)}{_after(self.unit)}"

    @property
    def _known(self) -> set[str]:
        return set(self.texts) - {NOTHING}

    @property
    def width(self) -> int:
        words = [word for line in self._words for word in line.split()]
        longest = min(max(map(len, words)), LONGEST_WORD)
        return max(longest, *(len(text) for text in self.texts))

    @property
    def _words(self) -> list[str]:
        return [self.name.replace(".", ". "), self.unit]

    @property
    def heading(self) -> str:
        lines = [textwrap.wrap(words, self.width) for words in self._words if words]
        return "\n".join(line for each in lines for line in each)


def tables(data: xarray.Dataset, width: int) -> list[Table]:
    """What varies, in as many tables as a terminal of `width` characters needs.

    Each begins with the axes. Where a point failed, its status stands beside them.
    """
    from rich.table import Table

    axes = [column for column in _axes(data) if column.varies]
    if not axes:
        return []
    metrics = [column for column in _metrics(data) if column.varies]
    status = _column(data, "status")
    leading = axes if set(status.texts) == {DONE} else [*axes, status]
    title = printable(str(data.attrs.get("title", "")))
    made: list[Table] = []
    for block in _blocks(leading, metrics, width):
        table = Table(title=None if made else title, title_justify="left")
        for column in [*leading, *block]:
            table.add_column(column.heading, justify="right", no_wrap=True, min_width=column.width)
        for row in zip(*(column.texts for column in [*leading, *block]), strict=True):
            table.add_row(*row)
        made.append(table)
    return made


def remarks(data: xarray.Dataset) -> Iterator[str]:
    """What the tables leave out: what is the same everywhere, reasons of failures, the peak."""
    columns = [*_axes(data), *_metrics(data)]
    same = [column.constant for column in columns if not column.varies]
    if same:
        yield f"the same at every point: {', '.join(same)}"
    yield from _left_out(data)
    axes = [str(name) for name in data.dims]
    for point in facts(data):
        if point["status"] != DONE:
            place = ", ".join(f"{name} = {_text(point[name])}" for name in axes)
            yield printable(f"{place}: {point['status']}: {point['reason']}")
    if "refined" in data.attrs:
        yield _peak(data)


def _left_out(data: xarray.Dataset) -> Iterator[str]:
    """Metrics of the scenario that no point has, where there are points to have them."""
    if not (data["status"] == DONE).any():
        return
    known = {str(column.attrs.get("long_name")) for column in data.data_vars.values()}
    for name in scenario_table(data.attrs, "metrics"):
        if name != "cycles" and name not in known:
            yield (
                f"metric left out: {printable(name)}: no point has a value; resilin inspect tells"
                " whether its variables are recorded"
            )


def _peak(data: xarray.Dataset) -> str:
    """The peak that was looked for, each number with its uncertainty."""
    name, axis = str(data.attrs["refined"]), str(next(iter(data.dims)))
    if "peak" not in data.attrs:
        return f"no peak of {name}: no point has a value"
    column = next(v for v in data.data_vars.values() if v.attrs.get("long_name") == name)
    unit, scale = shown_in(column)
    at, value = float(data.attrs["peak_at"]), scale * float(data.attrs["peak"])
    place_unit = str(data[axis].attrs.get("units", ""))
    if "peak_uncertainty" not in data.attrs:
        return (
            f"largest {name}: {value:.4g}{_after(unit)} at {axis} = {at:.4g}{_after(place_unit)};"
            " no peak is enclosed by points on both sides"
        )
    errors = [scale * data.attrs["peak_uncertainty"], data.attrs["peak_at_uncertainty"]]
    return (
        f"peak of {name}: {_with_error(value, errors[0])}{_after(unit)}"
        f" at {axis} = {_with_error(at, errors[1])}{_after(place_unit)}"
    )


def _with_error(value: float, error: float) -> str:
    """`50.61 +- 0.03`: the value to the second digit of its uncertainty, six digits at most."""
    if not (error > 0.0 and isfinite(value)):
        return f"{value:.6g}"
    size = floor(log10(abs(value))) if value else 0
    digits = min(max(size - floor(log10(error)) + 2, 2), 6)
    return f"{value:.{digits}g} +- {error:.2g}"


def shown_in(column: xarray.DataArray) -> tuple[str, float]:
    """Unit in which a column is shown, "" for a pure number, and how many of it its own unit is."""
    own = str(column.attrs.get("units", ""))
    unit = str(column.attrs.get("shown_in", own))
    try:
        scale = factor(own, unit) if own != unit else 1.0
    except UnitError:
        unit, scale = own, 1.0
    return ("" if unit == "1" else unit), scale


def metric_names(data: xarray.Dataset) -> list[str]:
    """Variables of a sweep that are metrics."""
    return [str(name) for name in data.data_vars if name not in BESIDE]


def _axes(data: xarray.Dataset) -> list[_Column]:
    return [_column(data, str(name)) for name in data.dims]


def _metrics(data: xarray.Dataset) -> list[_Column]:
    steps = _column(data, "steps")
    status = _column(data, "status").texts
    done = [t if s == DONE else NOTHING for t, s in zip(steps.texts, status, strict=True)]
    return [*(_column(data, name) for name in metric_names(data)), replace(steps, texts=done)]


def _column(data: xarray.Dataset, name: str) -> _Column:
    unit, scale = shown_in(data[name])
    values = _values(data, name)
    number = name not in data.dims and name not in BESIDE
    texts = [_measured(scale * value) if number else _text(value) for value in values]
    return _Column(printable(name), printable(unit), texts)


def _blocks(
    leading: Sequence[_Column], columns: Sequence[_Column], width: int
) -> list[list[_Column]]:
    """The columns in groups that fit beside the leading ones; at least one in each."""
    room = width - 1 - sum(column.width + FRAME for column in leading)
    blocks: list[list[_Column]] = [[]]
    used = 0
    for column in columns:
        needed = column.width + FRAME
        if blocks[-1] and used + needed > room:
            blocks.append([])
            used = 0
        blocks[-1].append(column)
        used += needed
    return blocks


def _values(data: xarray.Dataset, name: str) -> list[Any]:
    """A variable or an axis at every point; the last axis changes first."""
    return list(data[name].broadcast_like(data["status"]).values.ravel().tolist())


def _measured(value: float) -> str:
    return shown(value, "") if isfinite(value) else NOTHING


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else printable(str(value), most=40)


def _after(unit: str) -> str:
    return "" if unit in {"", "1"} else f" {unit}"
