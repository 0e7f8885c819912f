"""Folders of unpacked FMUs: one for each run, or one for all runs of a study."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from orchestrator.errors import FmuError
from orchestrator.fmi.built import digest_of
from orchestrator.simulation.guarded.kept import kept_between_runs
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.unpacked import FOLDERS, unpacked

pytestmark = pytest.mark.usefixtures("mark")


@pytest.fixture
def payload_fmu(library: Path) -> Path:
    return library / "payload.fmu"


def test_a_folder_lasts_for_one_run(payload_fmu: Path) -> None:
    digest = digest_of(payload_fmu)
    with unpacked(payload_fmu, digest, keep=True) as folder:
        assert (folder / "modelDescription.xml").is_file()
    assert not folder.exists()


def test_a_kept_one_serves_all(payload_fmu: Path) -> None:
    digest = digest_of(payload_fmu)
    with FOLDERS.inside():
        with unpacked(payload_fmu, digest, keep=True) as first:
            pass
        with unpacked(payload_fmu, digest, keep=True) as second, FOLDERS.inside():
            assert second == first
        with unpacked(payload_fmu, digest, keep=False) as third:
            assert third != first
        assert first.is_dir()
        assert not third.exists()
    assert not first.exists()


def test_a_file_that_has_changed_is_refused(payload_fmu: Path, tmp_path: Path) -> None:
    path = tmp_path / "changed.fmu"
    shutil.copy(payload_fmu, path)
    digest = digest_of(path)
    with FOLDERS.inside():
        with unpacked(path, digest, keep=True):
            pass
        with path.open("ab") as file:
            file.write(b"more")
        with (
            pytest.raises(FmuError, match="has changed since the scenario was loaded"),
            unpacked(path, digest, keep=True),
        ):
            pass


def test_runs_of_a_study_have_the_same_rows(library: Path, tmp_path: Path) -> None:
    plan = load("oscillator-1", None, library, time={"stop": "2 cycles"})
    alone = run(plan, estimate=False)
    with kept_between_runs():
        together = [run(plan, estimate=False) for _ in range(3)]
    assert {outcome.rows.tobytes() for outcome in together} == {alone.rows.tobytes()}
