"""The points of a sweep as one labelled netCDF file: metrics over the axes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError
from ...report.files import written_whole
from ...results.netcdf import netcdf_name, opened_file, partial_path, provenance
from ...scenario.settings import given
from .metric_units import shown_units
from .points import Grid, Point, Record

if TYPE_CHECKING:
    import xarray

KEPT = ("title", "scenario_file", "fmu_guids", "fmu_sha256", "resilin_version", "master", "laws")
"""The provenance that all runs of a sweep share."""

MISSING = Record("missing", "not run yet")
BESIDE = ("status", "reason", "wall_time", "steps", "added")
"""What a sweep knows of each point beside its metrics."""


def collected(
    grid: Grid,
    points: Sequence[Point],
    records: Mapping[str, Record],
    reason: str = "",
    refined: str | None = None,
) -> xarray.Dataset:
    """All points over the axes, which are dimensions; metrics and status as variables.

    Numbers on an axis rise. Points beyond those of the grid lie on its one axis, and are marked by
    `added`. Metrics are in SI, as `units` says; `shown_in` is the unit of tables and plots.
    `reason` is why points are missing, where any are; `refined` the metric whose peak has more.
    """
    import xarray

    rows = [records.get(point.key, MISSING) for point in points]
    shape = grid.shape if len(grid.shape) > 1 else (len(points),)
    dimensions = [netcdf_name(axis.name) for axis in grid.coordinates]
    columns = {
        name: (dimensions, values.reshape(shape), noted)
        for name, (values, noted) in [*_metrics(grid, rows), *_circumstances(rows)]
    }
    if len(points) > len(grid.points):
        own = {point.key for point in grid.points}
        added = np.array([int(point.key not in own) for point in points])
        noted = {"units": "1", "long_name": "1 for a point between those of the grid"}
        columns["added"] = (dimensions, added, noted)
    known = described(grid, refined) | {
        "complete": int(not any(row is MISSING for row in rows)),
        "reason": reason,
    }
    data = xarray.Dataset(columns, coords=_coordinates(grid, points, shape), attrs=known)
    rising = [name for name, axis in zip(dimensions, grid.coordinates, strict=True) if axis.numeric]
    return data.sortby(rising)


def _coordinates(grid: Grid, points: Sequence[Point], shape: tuple[int, ...]) -> dict[str, Any]:
    """Values on each axis with their unit and meaning."""
    made: dict[str, Any] = {}
    for k, axis in enumerate(grid.coordinates):
        places = np.array([point.place[k] for point in points], float if axis.numeric else object)
        ours = np.moveaxis(places.reshape(shape), k, 0).reshape(shape[k], -1)[:, 0]
        noted = {"long_name": axis.description} | ({"units": axis.unit} if axis.numeric else {})
        made[netcdf_name(axis.name)] = (netcdf_name(axis.name), ours, noted)
    return made


def _metrics(grid: Grid, rows: Sequence[Record]) -> list[tuple[str, tuple[Any, dict[str, str]]]]:
    """Values and labels of each metric; a name that is taken already gets `metric` before it."""
    taken = {*BESIDE, *(netcdf_name(axis.name) for axis in grid.coordinates)}
    shown_in = shown_units(grid.plan)
    units = {name: unit for row in rows for name, _, unit in row.metrics}
    made = []
    for name, unit in units.items():
        values = [row.metric(name) for row in rows]
        numbers = np.array([np.nan if value is None else value for value in values])
        noted = {"units": unit, "long_name": name, "shown_in": shown_in.get(name, unit)}
        own = netcdf_name(name)
        own = f"metric {own}" if own in taken else own
        taken.add(own)
        made.append((own, (numbers, noted)))
    return made


def _circumstances(rows: Sequence[Record]) -> list[tuple[str, tuple[Any, dict[str, str]]]]:
    """Status, reason, time and steps of each point."""
    times = np.array([row.wall_time if row is not MISSING else np.nan for row in rows])
    took = {"units": "s", "long_name": "Time that the point took on its worker"}
    steps = np.array([row.steps for row in rows])
    return [
        ("status", (np.array([row.status for row in rows], object), {})),
        ("reason", (np.array([row.reason for row in rows], object), {})),
        ("wall_time", (times, took)),
        ("steps", (steps, {"units": "1", "long_name": "Communication steps"})),
    ]


def described(grid: Grid, refined: str | None = None) -> dict[str, Any]:
    """Provenance of the sweep; the scenario is that of the first point.

    `points` digests all points and the metric whose peak is refined.
    """
    keys = json.dumps([refined, *sorted(point.key for point in grid.points)])
    known = provenance(grid.plan)
    first = grid.points[0]
    return (
        {name: known[name] for name in KEPT}
        | {
            "scenario": known["scenario"],
            "first_point": json.dumps(dict(zip(first.names, first.values, strict=True))),
            "changes": json.dumps(given(grid.setting.changes, grid.setting.options)),
            "axes": json.dumps([axis.name for axis in grid.coordinates]),
            "points": hashlib.sha256(keys.encode()).hexdigest()[:32],
        }
        | ({} if refined is None else {"refined": refined})
    )


def write(data: xarray.Dataset, path: Path) -> Path:
    """Write a sweep to `path`, or beside it as partial where points are missing.

    All is compressed and checksummed, texts too: a flipped bit is an error when it is read.
    """
    target = path if data.attrs["complete"] else partial_path(path)
    coded = {"zlib": True, "complevel": 1, "fletcher32": True}
    encoding: dict[Any, dict[str, Any]] = {
        name: coded | ({"dtype": "S1"} if variable.dtype == object else {})
        for name, variable in data.variables.items()
    }
    with written_whole(target, failures=(RuntimeError,)) as waiting:
        data.to_netcdf(waiting, engine="netcdf4", encoding=encoding)
    if data.attrs["complete"]:
        partial_path(path).unlink(missing_ok=True)
    return target


def read(path: Path) -> xarray.Dataset:
    """The result file of a sweep over its axes, all in memory; `InputError` where it is none."""
    with opened_file(path) as data:
        try:
            return over_axes(data.load())
        except (OSError, ValueError, RuntimeError, KeyError) as error:
            raise InputError(f"{path}: not a sweep that can be read ({error})") from None


def over_axes(data: xarray.Dataset) -> xarray.Dataset:
    """A sweep over its axes, also one of an earlier release, whose one dimension was `point`."""
    if "point" not in data.dims:
        return data
    axes = [netcdf_name(name) for name in json.loads(data.attrs["axes"])]
    if len(axes) == 1:
        return data.swap_dims(point=axes[0])
    labels = {name: data[name].attrs for name in axes}
    made = data.set_index(point=axes).unstack("point")
    for name, noted in labels.items():
        made[name].attrs.update(noted)
    return made
