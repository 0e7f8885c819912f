"""Sweeps of made-up metrics: datasets without a run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import xarray

from orchestrator.studies.sweep.axes import parse_axis
from orchestrator.studies.sweep.dataset import collected
from orchestrator.studies.sweep.points import Grid, Point, Record, Setting, planned
from tests.orchestrator.studies.sweeps import ok

Metrics = tuple[tuple[str, float, str], ...]


def grid(library: Path, *axes: str, scenario: str = "oscillator-1") -> Grid:
    """The checked points of a sweep."""
    setting = Setting(scenario, str(library), {}, {})
    return planned(setting, [parse_axis(axis) for axis in axes], ok)


def made(grid: Grid, metrics: Callable[[Point], Metrics]) -> xarray.Dataset:
    """The dataset of a sweep whose points have these metrics, and have failed without any."""
    records = {}
    for point in grid.points:
        found = metrics(point)
        records[point.key] = (
            Record("done", "", found, 1.0, 100) if found else Record("failed", "it fell apart")
        )
    return collected(grid, grid.points, records)
