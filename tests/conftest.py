"""Shared fixtures: the built parts, and scenes run on them."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

import build_fmus
from orchestrator.loading import load
from orchestrator.results import Outcome
from orchestrator.simulation import run

os.environ.setdefault("MPLBACKEND", "Agg")


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every part built once for this session."""
    folder = tmp_path_factory.mktemp("fmus")
    for name in build_fmus.part_names():
        build_fmus.build(name, into=folder)
    return folder


Runner = Callable[..., Outcome]


@pytest.fixture(scope="session")
def outcome(library: Path) -> Runner:
    """Run a scene on the built parts: `outcome(scene, changes, time={...}, master={...})`."""

    def runner(scene: str, changes: dict[str, str] | None = None, **options: object) -> Outcome:
        return run(load(scene, changes, library, **options))

    return runner
