"""Two dask workers for all tests that need no cluster of their own."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import pytest
import xarray
from distributed import LocalCluster

from orchestrator.studies.sweep.study import parse_axis, sweep
from orchestrator.studies.workers.dask_cluster import PRELOADED
from tests.orchestrator.studies.sweeps import SCENARIO, SHORT, Sweep, whole
from tests.processes import until


@pytest.fixture(scope="package")
def shared_cluster() -> Iterator[Any]:
    """Two workers whose nannies start them anew whenever they end, however long that takes."""
    made: Any = LocalCluster
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": 1e9}),
        made(
            n_workers=2,
            threads_per_worker=1,
            host="127.0.0.1",
            scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
            silence_logs=logging.CRITICAL,
            preload=PRELOADED,
        ) as running,
    ):
        yield running


@pytest.fixture
def cluster(shared_cluster: Any) -> Iterator[Any]:
    """The two workers, both there at the beginning and in the end."""
    until(lambda: whole(shared_cluster))
    yield shared_cluster
    until(lambda: whole(shared_cluster))


@pytest.fixture
def swept(cluster: Any, library: Path) -> Sweep:
    """`sweep` on the shared workers, over axes given as texts."""

    def run(
        *axes: str, scenario: str | Path = SCENARIO, target: Path, **more: Any
    ) -> xarray.Dataset:
        more = {"options": SHORT, "scheduler": cluster.scheduler_address} | more
        return sweep(scenario, [parse_axis(axis) for axis in axes], library, target, **more)

    return run
