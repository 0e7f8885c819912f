"""Result files and the metrics taken from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import OutputError
from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset, partial_path, prepare, write
from tests.conftest import Runner


def test_a_result_says_where_it_comes_from(outcome: Runner, tmp_path: Path) -> None:
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


def test_an_incomplete_run_stands_beside_its_place(outcome: Runner, tmp_path: Path) -> None:
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


def synthetic(frequency: float = 18.0, cycles: int = 10) -> xarray.Dataset:
    t = np.linspace(0.0, cycles / frequency, 40 * cycles + 1)
    w = 2 * np.pi * frequency
    top = np.where(np.sin(w * t + 1e-9) > 0, 1920.0, 0.0)
    columns = {
        "amplifier.top.voltage": top,
        "amplifier.bottom.voltage": 1920.0 - top,
        "amplifier.top_current": 1e-3 * np.sin(w * t),
        "amplifier.supplied_energy": 0.2 * t,
        "linkage.displacement": 1e-3 * np.sin(w * t - np.pi / 2) + 1e-4,
        "linkage.flap_angle": 0.5 * np.sin(w * t),
        "aero.lift": np.full_like(t, 1e-3),
    }
    return xarray.Dataset(
        {name: ("time", values) for name, values in columns.items()},
        coords={"time": t},
        attrs={"frequency": frequency},
    )


def test_metrics_of_known_signals() -> None:
    found = {m.name: m.value for m in metrics(synthetic())}
    assert found["flapping stroke"] == pytest.approx(1.0, rel=1e-3)
    assert found["travel"] == pytest.approx(2e-3, rel=1e-3)
    assert found["frequency"] == pytest.approx(18.0, rel=1e-3)
    assert found["phase"] == pytest.approx(np.pi / 2, abs=0.1)
    assert found["peak voltage"] == 1920.0
    assert found["peak current"] == pytest.approx(1e-3, rel=1e-2)
    assert found["electrical power"] == pytest.approx(0.2, rel=1e-6)
    assert found["mean lift"] == pytest.approx(1e-3)


def test_the_picture_is_drawn(outcome: Runner, tmp_path: Path) -> None:
    from orchestrator.results.plot import draw

    data = dataset(outcome("flapping-full-wings", time={"stop": "2 cycles"}))
    path = draw(data, tmp_path / "run.png")
    assert path.read_bytes().startswith(b"\x89PNG")
