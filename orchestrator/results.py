"""What a run leaves on disk: a labelled netCDF file that is whole, or says that it is not.

A file is written beside its place and renamed at the end. An incomplete run leaves
`NAME.partial.nc`, marked by its attribute `complete = 0` and the reason.
"""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .errors import OutputError
from .wiring import Plan

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class Outcome:
    """What a run recorded, and how it went. `failure` is None for a whole run."""

    plan: Plan
    names: list[str]
    times: NDArray[np.float64]
    rows: NDArray[np.float64]
    wall_time: float
    steps: int
    calls: dict[str, int]
    failure: Exception | None = field(default=None)

    def series(self, name: str) -> NDArray[np.float64]:
        """Recorded values of `component.variable`."""
        return np.asarray(self.rows[:, self.names.index(name)])


def dataset(outcome: Outcome) -> xarray.Dataset:
    """Recorded values over time, named `component.variable`, units and meaning as attributes.

    The dataset's attributes hold what is needed to run it again: scene, FMU digests,
    versions, master, step; and how it went.
    """
    import xarray

    plan = outcome.plan
    described = {f"{component}.{v.name}": v for component, v in plan.records}
    columns = {}
    for index, name in enumerate(outcome.names):
        said = {"units": described[name].unit, "long_name": described[name].description}
        safe = netcdf_name(name)
        if safe != name:
            said["original_name"] = name
        if safe in columns:
            safe = f"{safe}_{index}"
        columns[safe] = ("time", outcome.rows[:, index], said)
    time = ("time", outcome.times, {"units": "s", "long_name": "Time at which values hold"})
    return xarray.Dataset(columns, coords={"time": time}, attrs=attributes(outcome))


def netcdf_name(name: str) -> str:
    """A name that netCDF takes: what it does not take becomes `_`."""
    kept = "".join("_" if c == "/" or not c.isprintable() else c for c in name)
    short = kept.encode()[:200].decode(errors="ignore")
    return re.sub(r"^[^A-Za-z0-9_]|\s+$", "_", short)


def attributes(outcome: Outcome) -> dict[str, Any]:
    """Provenance of a run as netCDF attributes."""
    from importlib.metadata import PackageNotFoundError, version

    plan = outcome.plan
    try:
        release = version("resilin")
    except PackageNotFoundError:
        release = "unknown"
    digests = {name: interface.guid for name, interface in plan.interfaces.items()}
    archives = {
        name: hashlib.sha256(interface.path.read_bytes()).hexdigest()
        for name, interface in plan.interfaces.items()
    }
    return {
        "title": plan.scenario.title,
        "scene": plan.scenario.model_dump_json(by_alias=True),
        "scene_file": str(plan.path),
        "fmu_guids": json.dumps(digests),
        "fmu_sha256": json.dumps(archives),
        "resilin_version": release,
        "master": plan.scenario.master.kind,
        "laws": plan.scenario.master.laws,
        "communication_step": plan.grid.step,
        "frequency": plan.frequency or 0.0,
        "communication_steps": outcome.steps,
        "wall_time": outcome.wall_time,
        "complete": int(outcome.failure is None),
        "reason": str(outcome.failure or ""),
    }


def partial_path(path: Path) -> Path:
    """Where the records of an incomplete run go."""
    return path.with_name(path.name.removesuffix(".nc") + ".partial.nc")


def prepare(path: Path) -> None:
    """See that a result can be written to `path`, before any work is done for it."""
    if path.suffix != ".nc":
        raise OutputError(f"{path}: results are netCDF files; name it *.nc")
    try:
        if path.is_dir():
            raise OutputError(f"{path}: is a folder; name a file")
        path.parent.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise OutputError(f"{path.parent}: cannot be made for {path} ({reason})") from None
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise OutputError(f"{path.parent}: not writable ({error.strerror})") from None


def clear(path: Path) -> None:
    """Remove an earlier result and an earlier partial one from a place about to be filled."""
    path.unlink(missing_ok=True)
    partial_path(path).unlink(missing_ok=True)


def write(data: xarray.Dataset, path: Path) -> Path:
    """Write a dataset to `path`, or beside it as partial where it is not complete."""
    target = path if data.attrs["complete"] else partial_path(path)
    waiting = target.with_name(f".{target.name}.part")
    coded = {"zlib": True, "complevel": 1, "fletcher32": True}
    try:
        data.to_netcdf(waiting, engine="netcdf4", encoding=dict.fromkeys(data.variables, coded))
        waiting.replace(target)
    except (OSError, RuntimeError) as error:
        raise OutputError(f"{target}: cannot be written ({error})") from None
    finally:
        waiting.unlink(missing_ok=True)
    return target
