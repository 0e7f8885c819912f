"""Two sweeps side by side: how far each metric of one is from the other's, and at which point."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...results.comparison import chosen, unit_scale
from .table import SELECT, metric_names, shown_in

if TYPE_CHECKING:
    import xarray

SAME = 1e-9
"""Relative difference up to which two values on an axis are one: units convert with rounding."""
Places = NDArray[np.intp]
Shared = dict[str, tuple[Places, Places]]
"""Where on each axis the values are that two sweeps share: in the first one, and in the second."""


@dataclass(frozen=True)
class MetricDifference:
    """Second sweep minus first one of a metric, over the points at which both have a value.

    `largest` is the largest absolute difference, `at` the place on each axis where it is, `rms` the
    root of the mean square, all in SI; `relative` is `largest` over the first sweep's largest
    absolute value there. All are NaN, and `at` is empty, where `points` is 0. `shown_in` is the
    unit of tables and how many of it the SI unit is.
    """

    name: str
    unit: str
    largest: float
    at: dict[str, float | str]
    rms: float
    relative: float
    points: int
    shown_in: tuple[str, float]


@dataclass(frozen=True)
class SweepComparison:
    """Two sweeps over the points that both have, the largest relative difference first.

    `axes` gives the values on each axis, `alone` those that only the first sweep has and those that
    only the second has, also on axes of one value; `missing` the metrics that the first lacks, and
    the second.
    """

    axes: dict[str, list[float | str]]
    units: dict[str, str]
    alone: dict[str, tuple[list[float | str], list[float | str]]]
    differences: list[MetricDifference]
    missing: tuple[list[str], list[str]]

    @property
    def points(self) -> int:
        """How many points both have."""
        return math.prod(len(values) for values in self.axes.values())


def compared(
    one: xarray.Dataset, other: xarray.Dataset, *, patterns: Sequence[str] | None = None
) -> SweepComparison:
    """Compare two sweeps at the points that both have, nothing interpolated.

    `patterns` choose metrics. `InputError` where a pattern matches nothing that both have, the
    axes are not the same, or they have no point in common.
    """
    ours, theirs = without_settings([one, other])
    shared = _shared(ours, theirs)
    values, apart = _at(ours, shared, 0), difference(ours, theirs)
    found = [
        _difference(values[name], apart[name]) for name in chosen(metric_names(apart), patterns)
    ]
    found.sort(key=lambda each: -each.relative if isfinite(each.relative) else 0.0)
    metrics, others = metric_names(one), metric_names(other)
    return SweepComparison(
        axes={name: values[name].values.tolist() for name in shared},
        units={name: _unit(data[name]) for data in (other, one) for name in map(str, data.dims)},
        alone=dict(_alone(one, other)),
        differences=found,
        missing=(
            [name for name in others if name not in metrics],
            [name for name in metrics if name not in others],
        ),
    )


def difference(one: xarray.Dataset, other: xarray.Dataset) -> xarray.Dataset:
    """The second sweep minus the first one, metric by metric, at the points that both have.

    In the first one's units; NaN where one of them has no value. `InputError` as of `compared`.
    """
    shared = _shared(one, other)
    ours, theirs = _at(one, shared, 0), _at(other, shared, 1)
    made = ours[[name for name in metric_names(ours) if name in metric_names(theirs)]]
    for name in metric_names(made):
        there = in_unit_of(ours[name], theirs[name].transpose(*ours[name].dims))
        made[name] = ours[name].copy(data=there - ours[name].values)
    made.attrs.pop("refined", None)
    return made


def without_settings(sweeps: Iterable[xarray.Dataset]) -> list[xarray.Dataset]:
    """The sweeps without the axes on which none of them has several values."""
    known = list(sweeps)
    several = {name for data in known for name, size in data.sizes.items() if size > 1}
    return [data.squeeze([n for n in data.dims if n not in several], drop=True) for data in known]


def in_unit_of(one: xarray.DataArray, other: xarray.DataArray) -> NDArray[np.float64]:
    """Values of the second column in the unit of the first one; NaN where they do not fit."""
    return np.asarray(unit_scale(_unit(other), _unit(one)) * other.values)


def check_same_axes(one: xarray.Dataset, other: xarray.Dataset) -> None:
    """`InputError` unless both are over the same axes."""
    if set(one.dims) != set(other.dims):
        names = [", ".join(map(str, each.dims)) or "none" for each in (one, other)]
        raise InputError(
            f"one sweep has the axes {names[0]}; another has {names[1]}. Sweeps go together over"
            f" the same axes; {SELECT}"
        )


def _shared(one: xarray.Dataset, other: xarray.Dataset) -> Shared:
    check_same_axes(one, other)
    found = {str(name): _same(one[name], other[name]) for name in one.dims}
    for name, (ours, _) in found.items():
        if not len(ours):
            raise InputError(
                f"the sweeps have no point in common: no value of {name} is in both, and none is"
                " interpolated; sweep over values that meet"
            )
    return found


def _alone(
    one: xarray.Dataset, other: xarray.Dataset
) -> Iterator[tuple[str, tuple[list[float | str], list[float | str]]]]:
    """Values on each axis, and settings, that only one of two sweeps has."""
    for name in dict.fromkeys([*map(str, one.dims), *map(str, other.dims)]):
        if name not in one.dims or name not in other.dims:
            yield (
                name,
                tuple(d[name].values.tolist() if name in d.dims else [] for d in (one, other)),
            )
            continue
        left = [
            np.delete(data[name].values, places).tolist()
            for data, places in zip((one, other), _same(one[name], other[name]), strict=True)
        ]
        if any(left):
            yield name, (left[0], left[1])


def _same(one: xarray.DataArray, other: xarray.DataArray) -> tuple[Places, Places]:
    """Places of each value that is on both of two axes."""
    if not all(np.issubdtype(axis.dtype, np.number) for axis in (one, other)):
        known = {value: k for k, value in enumerate(other.values.tolist())}
        pairs = [(k, known[v]) for k, v in enumerate(one.values.tolist()) if v in known]
        ours, theirs = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        return ours, theirs
    there = in_unit_of(one, other)
    order = np.argsort(there)
    near = SAME * np.abs(one.values)
    places = np.searchsorted(there[order], one.values - near)
    closest = order[np.minimum(places, len(order) - 1)]
    meet = np.abs(there[closest] - one.values) <= near
    return np.flatnonzero(meet), closest[meet]


def _at(data: xarray.Dataset, shared: Shared, which: int) -> xarray.Dataset:
    return data.isel({name: places[which] for name, places in shared.items()})


def _difference(values: xarray.DataArray, apart: xarray.DataArray) -> MetricDifference:
    unit, shown = _unit(values), shown_in(values)
    sizes = np.abs(apart.values)
    known = np.isfinite(sizes)
    if not known.any():
        return MetricDifference(str(apart.name), unit, nan, {}, nan, nan, 0, shown)
    worst = np.unravel_index(np.nanargmax(sizes), sizes.shape)
    largest, size = float(sizes[worst]), float(np.max(np.abs(values.values[known])))
    places = zip(apart.dims, worst, strict=True)
    return MetricDifference(
        str(apart.name),
        unit,
        largest,
        {str(name): apart[name].values.tolist()[k] for name, k in places},
        float(np.sqrt(np.mean(sizes[known] ** 2))),
        largest / size if size > 0.0 else (0.0 if largest == 0.0 else nan),
        int(known.sum()),
        shown,
    )


def _unit(column: xarray.DataArray) -> str:
    return str(column.attrs.get("units", ""))
