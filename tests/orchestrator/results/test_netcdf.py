"""Result files and the metrics taken from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import OutputError
from orchestrator.results.netcdf import dataset, partial_path, prepare, write
from tests.conftest import Runner


def test_a_result_carries_its_provenance(outcome: Runner, tmp_path: Path) -> None:
    done = outcome("flapping-full-wings", time={"stop": "3 cycles"})
    data = dataset(done)
    path = write(done, tmp_path / "run.nc")
    with xarray.open_dataset(path) as read:
        assert read["linkage.flap_angle"].attrs["units"] == "rad"
        assert read["linkage.displacement"].dims == ("time",)
        assert read.attrs["complete"] == 1
        assert read.attrs["master"] == "gauss-seidel"
        assert "amplifier" in read.attrs["fmu_guids"]
        np.testing.assert_array_equal(read["time"].values, data["time"].values)
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_an_incomplete_run_is_written_beside_its_place(outcome: Runner, tmp_path: Path) -> None:
    failed = outcome(
        "oscillator-1", {"payload.start_velocity": "9000", "spring.blocked_force": "0"}
    )
    assert failed.failure is not None
    path = write(failed, tmp_path / "run.nc")
    assert path == tmp_path / "run.partial.nc" == partial_path(tmp_path / "run.nc")
    with xarray.open_dataset(path) as read:
        assert read.attrs["complete"] == 0
        assert "outside" in read.attrs["reason"]
    assert not (tmp_path / "run.nc").exists()


@pytest.mark.parametrize("name", ["run.csv", "run"])
def test_only_netcdf_is_written(tmp_path: Path, name: str) -> None:
    with pytest.raises(OutputError, match=r"\*\.nc"):
        prepare(tmp_path / name)


def test_the_plot_is_drawn(outcome: Runner, tmp_path: Path) -> None:
    from orchestrator.results.plot import draw

    data = dataset(outcome("flapping-full-wings", time={"stop": "2 cycles"}))
    path = draw(data, tmp_path / "run.png")
    assert path.read_bytes().startswith(b"\x89PNG")
