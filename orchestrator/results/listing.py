"""The results in a folder: what each is of, how far it came, when it was written."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from ..errors import InputError
from .netcdf import netcdf_name
from .recorded import is_sweep
from .run_notes import RunNotes, read


@dataclass(frozen=True)
class Entry:
    """A result file. `kind` is run, sweep, partial or unreadable; `extent` is how much it holds."""

    path: Path
    kind: str
    title: str
    extent: str
    written: datetime
    size: int
    notes: RunNotes = field(default_factory=RunNotes)


def results_in(folder: Path) -> list[Entry]:
    """Results of a folder, the newest first; `InputError` where there is no such folder."""
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; resilin run makes results")
    found = [entry_of(path) for path in folder.glob("*.nc") if path.is_file()]
    return sorted(found, key=lambda entry: (-entry.written.timestamp(), entry.path))


def entry_of(path: Path) -> Entry:
    """What one file holds, read as far as it can be."""
    import netCDF4

    status = path.stat()
    written = datetime.fromtimestamp(status.st_mtime)
    try:
        with netCDF4.Dataset(path) as file:
            noted = {name: file.getncattr(name) for name in file.ncattrs()}
            sizes = {name: len(dimension) for name, dimension in file.dimensions.items()}
            end = float(file["time"][-1]) if sizes.get("time") else 0.0
    except (OSError, RuntimeError, IndexError, ValueError):
        return Entry(path, "unreadable", "", "", written, status.st_size)
    title = str(noted.get("title", ""))
    if is_sweep(noted):
        axes = {"point", *map(netcdf_name, json.loads(noted["axes"]))}
        counts = [size for name, size in sizes.items() if name in axes]
        kind, extent = "sweep", f"{' x '.join(map(str, counts))} points"
    else:
        kind, extent = "run", f"{sizes.get('time', 0)} rows to {end:.4g} s"
    if not noted.get("complete", 1):
        kind = "partial"
    return Entry(path, kind, title, extent, written, status.st_size, read(noted))
