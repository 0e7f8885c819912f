"""Folders for temporary files: none is left, whatever has become of the run."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from orchestrator.results.lock import Lock
from orchestrator.simulation import scratch
from orchestrator.simulation.scratch import Scratch
from tests.processes import python, started, until


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files, which no run of this process has looked at."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    scratch._sweep.cache_clear()
    return tmp_path


def aged(folder: Path) -> Path:
    """A folder that was made an hour ago."""
    folder.mkdir(exist_ok=True)
    (folder / "file").touch()
    os.utime(folder, (folder.stat().st_mtime - 3600.0,) * 2)
    return folder


def test_what_a_killed_process_has_left_is_removed(place: Path) -> None:
    code = (
        "import time; from pathlib import Path; from orchestrator.simulation.scratch import Scratch"
        "; held = Scratch(Path('x')); print('made', flush=True); time.sleep(600)"
    )
    with started(python("-c", code), TMPDIR=str(place)) as process:
        until(lambda: list(place.glob("resilin-*")), process)
        (left,) = place.glob("resilin-*")
        assert process.stdout is not None
        process.stdout.readline()
        aged(left)
        with Scratch(Path("a")):
            assert left.is_dir()
        process.kill()
        process.wait()
    scratch._sweep.cache_clear()
    with Scratch(Path("a")):
        assert not left.exists()


def test_what_is_held_fresh_or_of_others_stays(place: Path) -> None:
    held, fresh, other = place / "resilin-a", place / "resilin-b", place / "another"
    lock = Lock(aged(held))
    assert lock.take()
    fresh.mkdir()
    aged(other)
    with Scratch(Path("a")) as mine:
        assert mine.parent == place
        assert {held, fresh, other, mine} == set(place.iterdir())
    assert not mine.exists()
    lock.release()


def test_a_lock_is_sure_only_where_the_system_has_some(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl

    def none(*given: object) -> None:
        raise OSError("no locks here")

    monkeypatch.setattr(fcntl, "flock", none)
    assert Lock(place).take()
    assert not Lock(place).take(sure=True)
