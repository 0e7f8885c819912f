"""The points of a sweep as one labelled netCDF file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...report.files import written_whole
from ...results.netcdf import netcdf_name, partial_path, provenance
from .points import Grid, Point, Record

if TYPE_CHECKING:
    import xarray

KEPT = ("title", "scenario_file", "fmu_guids", "fmu_sha256", "resilin_version", "master", "laws")
"""The provenance that all runs of a sweep share."""

MISSING = Record("missing", "not run yet")


def collected(
    grid: Grid, points: Sequence[Point], records: Mapping[str, Record], reason: str = ""
) -> xarray.Dataset:
    """All points over dimension `point`: axes as coordinates, metrics and status as variables.

    `reason` is why points are missing, where any are.
    """
    import xarray

    rows = [records.get(point.key, MISSING) for point in points]
    coordinates: dict[str, Any] = {}
    for k, axis in enumerate(grid.coordinates):
        places = np.array([point.place[k] for point in points], float if axis.numeric else object)
        attributes = {"long_name": axis.description}
        attributes |= {"units": axis.unit} if axis.numeric else {}
        coordinates[netcdf_name(axis.name)] = ("point", places, attributes)
    units = {name: unit for row in rows for name, _, unit in row.metrics}
    columns: dict[str, Any] = {}
    for name, unit in units.items():
        values = [row.metric(name) for row in rows]
        numbers = np.array([np.nan if value is None else value for value in values])
        columns[netcdf_name(name)] = ("point", numbers, {"units": unit, "long_name": name})
    columns |= _circumstances(rows)
    known = _provenance(grid) | {
        "complete": int(not any(row is MISSING for row in rows)),
        "reason": reason,
    }
    return xarray.Dataset(columns, coords=coordinates, attrs=known)


def _circumstances(rows: Sequence[Record]) -> dict[str, Any]:
    """Status, reason, time and steps of each point."""
    return {
        "status": ("point", np.array([row.status for row in rows], object)),
        "reason": ("point", np.array([row.reason for row in rows], object)),
        "wall_time": (
            "point",
            np.array([row.wall_time if row is not MISSING else np.nan for row in rows]),
            {"units": "s", "long_name": "Time that the point took on its worker"},
        ),
        "steps": (
            "point",
            np.array([row.steps for row in rows]),
            {"units": "1", "long_name": "Communication steps"},
        ),
    }


def _provenance(grid: Grid) -> dict[str, Any]:
    """Provenance of the sweep; the scenario is that of the first point."""
    known = provenance(grid.plan)
    first = grid.points[0]
    return {name: known[name] for name in KEPT} | {
        "scenario": known["scenario"],
        "first_point": json.dumps(dict(zip(first.names, first.values, strict=True))),
        "axes": json.dumps([axis.name for axis in grid.coordinates]),
    }


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
