"""Which FMUs may run inside the master: those that were built here, whatever others say."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

import build_fmus
from orchestrator.errors import FmuError
from orchestrator.fmi.built import digest_of, is_built_here, ledger, note
from orchestrator.scenario.inspection import facts
from orchestrator.simulation.load import load
from orchestrator.simulation.system import System
from tests.orchestrator.good_scenario import changed


def forged(library: Path, folder: Path) -> Path:
    """A scenario of an FMU that says what a part of ours says, and is another file."""
    with (
        zipfile.ZipFile(library / "payload.fmu") as old,
        zipfile.ZipFile(folder / "forged.fmu", "w") as new,
    ):
        for entry in old.namelist():
            new.writestr(entry, old.read(entry))
        new.writestr("extra/more", b"")
    path = folder / "forged.toml"
    path.write_text(changed('fmu = "payload"', 'fmu = "forged.fmu"'))
    return path


def test_a_part_that_was_built_here_runs_inside_the_master(library: Path, desk: Path) -> None:
    plan = load("good.toml", None, library)
    assert is_built_here(plan.digests["payload"])
    assert facts(plan)["units"]["payload"]["isolated"] is False


def test_an_fmu_that_only_says_so_runs_in_a_process_of_its_own(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = load(forged(library, tmp_path), None, library)
    assert facts(plan)["units"]["payload"]["isolated"] is True
    assert "was not built on this machine" in plan.interfaces["payload"].warnings[0]
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    note(plan.interfaces["payload"].path)
    assert (
        facts(load(tmp_path / "forged.toml", None, library))["units"]["payload"]["isolated"]
        is False
    )


def test_a_file_of_others_with_our_identity_is_built_anew(
    python_parts: Path, tmp_path: Path
) -> None:
    """The GUID is in the file, where anybody can write it."""
    own = tmp_path / "payload.fmu"
    forged(python_parts, tmp_path)
    (tmp_path / "forged.fmu").rename(own)
    assert build_fmus.build("payload", into=tmp_path).fresh
    assert digest_of(own) == digest_of(python_parts / "payload.fmu")
    assert not build_fmus.build("payload", into=tmp_path).fresh


def test_a_list_that_cannot_be_written_is_an_error_with_a_way_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    with pytest.raises(build_fmus.BuildError, match="set XDG_STATE_HOME to a folder"):
        build_fmus.build("payload", into=tmp_path)


def test_the_ledger_is_the_users_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    file = tmp_path / "x.fmu"
    file.write_bytes(b"x")
    assert not is_built_here(digest_of(file))
    note(file)
    note(file)
    assert ledger() == tmp_path / "state" / "resilin" / "built"
    assert ledger().read_text().split() == [digest_of(file)]
    assert is_built_here(digest_of(file))
    monkeypatch.setenv("XDG_STATE_HOME", "relative")
    assert ledger().is_absolute()


def test_an_fmu_that_has_changed_since_it_was_checked_is_refused(
    library: Path, tmp_path: Path
) -> None:
    plan = load(forged(library, tmp_path), None, library)
    with zipfile.ZipFile(tmp_path / "forged.fmu", "a") as archive:
        archive.writestr("extra/other", b"")
    with pytest.raises(FmuError, match=r"forged\.fmu: has changed since"), System(plan):
        pass


def test_an_fmu_that_goes_away_during_a_run_costs_nothing(library: Path, tmp_path: Path) -> None:
    from orchestrator.results.netcdf import write
    from orchestrator.simulation.run import run

    plan = load(forged(library, tmp_path), None, library)

    class Remover:
        def start(self, *arguments: object) -> None:
            plan.interfaces["payload"].path.unlink()

        def sample(self, view: object) -> None:
            pass

    done = run(plan, observers=[Remover()])
    assert write(done.checked(), tmp_path / "run.nc").exists()
