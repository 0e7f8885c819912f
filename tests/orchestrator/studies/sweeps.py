"""What tests of sweeps share: a short scenario, its axis of frequencies, points on disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray
from distributed import Status

from orchestrator.studies.sweep.checkpoint import Checkpoint

SCENARIO = "flapping-spring-full-wings"
SHORT = {"time": {"stop": "2 cycles"}}
STROKE = "flapping stroke"
Sweep = Callable[..., xarray.Dataset]


def files(target: Path) -> dict[str, int]:
    """Finished points on disk, with the time at which each was written."""
    folder = Checkpoint(target).path
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.json")}


def whole(cluster: Any) -> bool:
    """Whether all workers of a cluster are there, none being started anew."""
    here = cluster.scheduler.workers
    return all(
        nanny.status == Status.running and nanny.pid and nanny.worker_address in here
        for nanny in cluster.workers.values()
    )


def ok() -> None:
    """Nothing to interrupt."""
