"""Schedulers at an address: that go away, and that are not there."""

from __future__ import annotations

import logging
import subprocess
from pathlib import Path
from typing import Any

import pytest
from distributed import LocalCluster

from orchestrator.errors import InputError, SimulationError
from orchestrator.studies.sweep.study import parse_axis, sweep
from orchestrator.studies.workers import dask_cluster
from tests.orchestrator.studies.sweeps import SCENARIO, SHORT, Sweep, files
from tests.processes import python, when


@pytest.mark.slow
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


@pytest.mark.slow
def test_workers_import_nothing_from_the_current_folder(library: Path, tmp_path: Path) -> None:
    """Nor does what starts them: a module there may have the name of one of Python's own."""
    for name in ("multiprocessing", "random", "numpy"):
        (tmp_path / f"{name}.py").write_text("open('imported', 'w').close()\n")
    code = """
import sys
sys.path[:] = [p for p in sys.path if p]
from orchestrator.studies.workers import dask_cluster
if __name__ == "__main__":
    with dask_cluster.local(1) as client:
        print(client.run(abs, -1))
"""
    (tmp_path / "main.py").write_text(code)
    done = subprocess.run(
        python("-P", "main.py"), cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert ": 1}" in done.stdout
    assert not (tmp_path / "imported").exists()


@pytest.mark.parametrize("protocol", ["tls", pytest.param("tcp", marks=pytest.mark.slow)])
def test_a_cluster_of_ours_serves_nobody_else(protocol: str) -> None:
    """Whoever reaches a scheduler may have it run anything; ours asks for its own certificate."""
    with dask_cluster.local(1) as client:
        assert client.submit(abs, -1).result() == 1
        address = client.scheduler.address.replace("tls", protocol)
        with pytest.raises(InputError, match="no answer"), dask_cluster.remote(address):
            pass
