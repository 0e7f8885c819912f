"""The results in a folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import xarray

from orchestrator.errors import InputError
from orchestrator.results.listing import results_in


def test_results_are_listed_with_what_they_hold(tmp_path: Path) -> None:
    rows = xarray.Dataset({"a.b": ("time", [1.0, 2.0])}, {"time": [0.0, 0.5]}, {"title": "A run"})
    points = xarray.Dataset(
        {"travel": (("a.x", "a.y"), [[1.0, 2.0, 3.0]]), "status": (("a.x", "a.y"), [["done"] * 3])},
        {"a.x": [1.0], "a.y": ["p", "q", "r"]},
        {"title": "A sweep", "axes": '["a.x", "a.y"]'},
    )
    coded = {name: {"dtype": "S1"} for name in ("status", "a.y")}
    rows.to_netcdf(tmp_path / "run.nc")
    rows.assign_attrs(complete=0).to_netcdf(tmp_path / "half.partial.nc")
    points.to_netcdf(tmp_path / "sweep.nc", encoding=coded)
    points.stack(point=["a.x", "a.y"]).reset_index("point").to_netcdf(tmp_path / "earlier.nc")
    (tmp_path / "broken.nc").write_text("no netCDF")
    (tmp_path / "notes.txt").write_text("no result")
    for age, name in enumerate(["sweep", "run", "half.partial", "earlier", "broken"]):
        os.utime(tmp_path / f"{name}.nc", (1e9 - age, 1e9 - age))
    assert [(e.path.stem, e.kind, e.title, e.extent) for e in results_in(tmp_path)] == [
        ("sweep", "sweep", "A sweep", "1 x 3 points"),
        ("run", "run", "A run", "2 rows to 0.5 s"),
        ("half.partial", "partial", "A run", "2 rows to 0.5 s"),
        ("earlier", "sweep", "A sweep", "3 points"),
        ("broken", "unreadable", "", ""),
    ]


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none: no such folder; resilin run makes results"):
        results_in(tmp_path / "none")
