"""Schedulers at an address: that go away, and that are not there."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import pytest
from distributed import LocalCluster

from orchestrator.errors import InputError, SimulationError
from orchestrator.studies.sweep.study import parse_axis, sweep
from tests.orchestrator.studies.sweeps import SCENARIO, SHORT, Sweep, files
from tests.processes import when


def test_a_scheduler_that_goes_away_is_reported(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    made: Any = LocalCluster
    with made(
        n_workers=1,
        threads_per_worker=1,
        scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
        silence_logs=logging.CRITICAL,
    ) as own:
        axes = [parse_axis("amplifier.frequency=5:40/100Hz")]
        reason = r"gone.*; \d+ of 100 points are kept in .*points"
        with when(lambda: files(target), own.close), pytest.raises(SimulationError, match=reason):
            sweep(SCENARIO, axes, library, target, scheduler=own.scheduler_address, options=SHORT)
    assert files(target)


def test_a_scheduler_that_is_not_there_is_reported(
    swept: Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("orchestrator.studies.workers.dask_cluster.CONNECTING", 0.5)
    with pytest.raises(InputError, match="dask scheduler"):
        swept("amplifier.frequency=17Hz", target=tmp_path / "out.nc", scheduler="tcp://127.0.0.1:9")
