"""A result that another run would overwrite is kept, under a name with its digest."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import KeptWarning, OutputError
from ..scenario.files import is_file
from .scenario_attribute import NAMES

IDENTITY = ("fmu_sha256", "points")
"""What makes a result another one, beside its scenario: FMU files, and the points of a sweep."""
BESIDE = (".nc", ".png")


def keep_other(path: Path, attributes: Mapping[str, Any]) -> Path | None:
    """Rename the result at `path` where it is not of the run that `attributes` describe.

    `results/a.nc` becomes `results/a.DIGEST.nc`, its plot with it, and a `KeptWarning` names it.
    None where nothing was renamed: no result there, or one of the same scenario and FMUs.
    """
    earlier = _attributes(path)
    if not earlier or digest(earlier) == digest(attributes):
        return None
    kept = path.with_name(f"{path.stem}.{digest(earlier)}{path.suffix}")
    try:
        for suffix in BESIDE:
            if path.with_suffix(suffix).is_file():
                path.with_suffix(suffix).replace(kept.with_suffix(suffix))
    except OSError as error:
        raise OutputError(f"{path}: cannot be renamed to {kept} ({error.strerror})") from None
    warnings.warn(
        f"{path} held a result of another setting or FMU, which is now {kept}; --name names a"
        " result",
        KeptWarning,
        stacklevel=2,
    )
    return kept


def digest(attributes: Mapping[str, Any]) -> str:
    """Eight digits that tell results of different scenarios, FMUs or sweeps apart."""
    scenario = next((attributes[name] for name in NAMES if name in attributes), "")
    identity = [str(scenario), *(str(attributes.get(key, "")) for key in IDENTITY)]
    return hashlib.sha256(json.dumps(identity).encode()).hexdigest()[:8]


def _attributes(path: Path) -> dict[str, Any]:
    """Attributes of a result; empty where there is none to read, or no scenario in it."""
    if not is_file(path):
        return {}
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            found = {name: file.getncattr(name) for name in file.ncattrs()}
    except (OSError, RuntimeError):
        return {}
    return found if any(name in found for name in NAMES) else {}
