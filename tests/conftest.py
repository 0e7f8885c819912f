"""Shared fixtures: built FMUs, scenarios run on them, and that a test leaves nothing behind."""

from __future__ import annotations

import fcntl
import functools
import os
import tempfile
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import build_fmus
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.build import foreign
from tests.foreign.scenarios import Shelf
from tests.processes import MARK, dead_children, marked

os.environ.setdefault("MPLBACKEND", "Agg")


@pytest.fixture(scope="session", autouse=True)
def estimates_are_asked_for() -> Iterator[None]:
    """No run is made thrice unasked: a test that is about the estimate asks for it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("orchestrator.simulation.run.BUDGET", -1.0)
        yield


def once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """A folder that the first worker of a session fills for all of them."""
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / name
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "made").exists():
            make(folder)
            (folder / "made").touch()
    return folder


@pytest.fixture(scope="session")
def python_parts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every part as pythonfmu exports it, built once for all workers of a session."""

    def build(folder: Path) -> None:
        for name in build_fmus.part_names():
            build_fmus.build(name, into=folder)

    return once(tmp_path_factory, "fmus", build)


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every part that can be compiled, built once for all workers of a session."""

    def build(folder: Path) -> None:
        for name in build_fmus.compilable():
            build_fmus.build(name, into=folder, native=True)

    return once(tmp_path_factory, "native", build)


@pytest.fixture(scope="session")
def native_fmi3(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same parts as FMUs of FMI 3, built once for all workers of a session."""

    def build(folder: Path) -> None:
        for name in build_fmus.compilable():
            build_fmus.build(name, into=folder, native=True, fmi=3)

    return once(tmp_path_factory, "fmi3", build)


@pytest.fixture(scope="session")
def library(native: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every part: compiled, but for the monolith, which is in Python alone.

    The compiled parts give the same bits as those in Python (tests/fmus/native, and whole scenarios
    in tests/orchestrator/simulation/test_native_fmus.py), in a tenth of the time. Tests of the
    parts themselves, and of tools that step them, have the Python ones in its place.
    """

    def gather(folder: Path) -> None:
        for path in native.glob("*.fmu"):
            (folder / path.name).symlink_to(path)
        for name in set(build_fmus.part_names()) - set(build_fmus.compilable()):
            build_fmus.build(name, into=folder)

    return once(tmp_path_factory, "compiled", gather)


Runner = Callable[..., Outcome]


@pytest.fixture(scope="session")
def outcome(library: Path) -> Runner:
    """Run a scenario on these parts: `outcome(scenario, changes, time={...}, master={...})`."""

    def runner(scenario: str, changes: dict[str, str] | None = None, **options: object) -> Outcome:
        return run(load(scenario, changes, library, **options))

    return runner


@pytest.fixture(scope="session")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Shelf:
    """A foreign FMU, `shelf(model, version, **options)`, built where it is not there yet."""

    @functools.cache
    def take(model: str, version: int, **options: object) -> Path:
        return foreign(model, tmp_path_factory.mktemp(model), version=version, **options)  # type: ignore[arg-type]

    return take


@pytest.fixture
def mark(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """What all processes of a test carry in their environment: none is left, and no folder."""
    word = uuid.uuid4().hex
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv(MARK, word)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    dead = dead_children()
    yield word
    left = marked(word)
    for process in left:
        process.kill()
    assert left == []
    assert dead_children() <= dead
    assert list(temporary.iterdir()) == []
