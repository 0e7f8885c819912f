"""Shared fixtures: the built parts, and scenarios run on them."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path

import pytest

import build_fmus
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

os.environ.setdefault("MPLBACKEND", "Agg")


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every part built once for this session."""
    folder = tmp_path_factory.mktemp("fmus")
    for name in build_fmus.part_names():
        build_fmus.build(name, into=folder)
    return folder


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every part that can be compiled, built once for all workers of a session."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "native"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for name in build_fmus.compilable():
            build_fmus.build(name, into=folder, native=True)
    return folder


Runner = Callable[..., Outcome]


@pytest.fixture(scope="session")
def outcome(library: Path) -> Runner:
    """Run a scenario on the built parts: `outcome(scenario, changes, time={...}, master={...})`."""

    def runner(scenario: str, changes: dict[str, str] | None = None, **options: object) -> Outcome:
        return run(load(scenario, changes, library, **options))

    return runner
