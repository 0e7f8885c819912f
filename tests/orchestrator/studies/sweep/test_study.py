"""Sweeps from axes to one file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import xarray

from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset
from orchestrator.studies.sweep.study import parse_axis, sweep
from tests.conftest import Runner
from tests.orchestrator.studies.sweeps import SCENARIO, SHORT, STROKE, Sweep


def test_results_equal_a_direct_run(swept: Sweep, outcome: Runner, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    axes = ["amplifier.frequency=16,18 Hz", "amplifier.waveform=square,sine"]
    data = swept(*axes, target=target, changes={"linkage.damping": "0.2"})
    changes = {"amplifier.frequency": "18 Hz", "amplifier.waveform": "sine"}
    direct = outcome(SCENARIO, {"linkage.damping": "0.2"} | changes, **SHORT)
    with xarray.open_dataset(target) as read:
        assert read["status"].sizes == {"amplifier.frequency": 2, "amplifier.waveform": 2}
        point = read.sel({"amplifier.waveform": "sine"}).sel(
            {"amplifier.frequency": 18.4}, method="nearest"
        )
        for metric in metrics(dataset(direct)):
            assert point[metric.name] == metric.value
            assert point[metric.name].attrs["units"] == metric.unit
        np.testing.assert_array_equal(read["amplifier.frequency"].values, [16, 18])
        assert read["amplifier.frequency"].attrs["units"] == "Hz"
        assert list(read["amplifier.waveform"].values) == ["square", "sine"]
        assert set(read.coords) == {"amplifier.frequency", "amplifier.waveform"}
        assert set(read["status"].values.flat) == {"done"}
        assert set(read["reason"].values.flat) == {""}
        assert (read["steps"].values == direct.steps).all()
        assert (read["wall_time"].values > 0.0).all()
        assert read.attrs["complete"] == 1
        xarray.testing.assert_equal(read.load(), data)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


@pytest.mark.slow
def test_figure_11(cluster: Any, library: Path, tmp_path: Path) -> None:
    """On workers of its own; they are gone at the end, and the environment is as before."""
    assert cluster.workers
    before = dict(os.environ)
    there = set(psutil.Process().children(recursive=True))
    target = tmp_path / "figure11.nc"
    axes = [parse_axis("amplifier.frequency=14:22/3Hz")]
    data = sweep(SCENARIO, axes, library, target, options={"time": {"stop": "5 cycles"}}, workers=2)
    stroke = data[STROKE].values
    assert stroke[1] > stroke[0] and stroke[1] > stroke[2]
    assert os.environ == before
    assert set(psutil.Process().children(recursive=True)) <= there
