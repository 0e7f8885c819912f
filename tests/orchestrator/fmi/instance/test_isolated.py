"""Instances in processes of their own: the same numbers, and how the process starts and ends."""

from __future__ import annotations

import errno
import os
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import InitialisationError
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance import Limits, open_instance
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.system import System
from tests.foreign.scenarios import (
    Shelf,
    each_version,
    hold,
    masses,
    part,
    ran,
    ring,
    scenario,
)
from tests.processes import hosts

pytestmark = pytest.mark.usefixtures("mark")


@pytest.mark.parametrize(
    ("versions", "rollback", "master", "error"),
    [
        ((2, 2), True, "interface-newton", 3e-4),
        ((3, 3), True, "iterative", 3e-4),
        ((2, 2), False, "extrapolated", 6e-4),
        ((3, 3), False, "extrapolated", 6e-4),
        ((3, 2), False, "gauss-seidel", 6e-2),
    ],
)
def test_two_masses_follow_the_closed_form_isolated_or_not(
    versions: tuple[int, int],
    rollback: bool,
    master: str,
    error: float,
    shelf: Shelf,
    tmp_path: Path,
) -> None:
    """x1 = (cos wt + cos Wt)/2 with w^2 = 3, W^2 = 7, and x2 with a minus between."""
    apart, guarded, together = (
        ran(masses(tmp_path, shelf, versions, master=master, isolate=isolate, rollback=rollback))
        for isolate in (True, None, False)
    )
    slow, fast = (np.cos(np.sqrt(square) * apart.times) for square in (3.0, 7.0))
    assert np.abs(apart.series("a.displacement") - 0.5 * (slow + fast)).max() < error
    assert np.abs(apart.series("b.displacement") - 0.5 * (slow - fast)).max() < error
    for other in (guarded, together):
        assert apart.rows.tobytes() == other.rows.tobytes()
        assert apart.times.tobytes() == other.times.tobytes()
        assert (apart.calls, apart.rollbacks) == (other.calls, other.rollbacks)
    assert guarded.python_loop == together.python_loop
    assert list(guarded.points) == list(together.points)
    assert guarded.couplings == together.couplings


def test_steps_by_tolerance_are_the_same_isolated_or_not(shelf: Shelf, tmp_path: Path) -> None:
    more = "tolerance = 1e-3"
    apart, guarded, together = (
        ran(masses(tmp_path, shelf, master="extrapolated", more=more, isolate=isolate, stop=1.0))
        for isolate in (True, None, False)
    )
    for other in (guarded, together):
        assert apart.rejected == other.rejected
        assert apart.points == other.points
        assert apart.rows.tobytes() == other.rows.tobytes()
    slow, fast = (np.cos(np.sqrt(square) * apart.times) for square in (3.0, 7.0))
    assert np.abs(apart.series("a.displacement") - 0.5 * (slow + fast)).max() < 1e-2


def test_foreign_instances_are_isolated_and_ours_are_not(
    shelf: Shelf, library: Path, tmp_path: Path, mark: str
) -> None:
    ours, theirs = part("ours", "payload"), part("theirs", shelf("MASS", 2))
    held = hold({"ours.force.value": 0.0, "theirs.force": 0.0})
    with System(load(scenario(tmp_path, ours, theirs, held), library=library)) as system:
        assert [len(hosts(mark)), len(system.instances)] == [1, 2]
    assert hosts(mark) == []
    with System(load(scenario(tmp_path, ours, hold({"ours.force.value": 0.0})), library=library)):
        assert hosts(mark) == []


def test_ours_are_the_same_isolated(library: Path, tmp_path: Path) -> None:
    def rows(isolate: bool) -> bytes:
        ours = part("p", "payload", isolate=isolate)
        path = scenario(tmp_path, ours, hold({"p.force.value": 0.01}))
        return ran(path, library=library).rows.tobytes()

    assert rows(True) == rows(False)


@each_version
def test_fmu_that_allows_one_instance_gets_a_process_for_each(
    version: int, shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    path = ring(tmp_path, shelf("GAIN", version, once=True), (0.5, 0.5))
    with System(load(path)):
        assert len(hosts(mark)) == 2
    ran(path)
    path = ring(tmp_path, shelf("GAIN", version, once=True), (0.5, 0.5), isolate=False)
    with pytest.raises(InitialisationError, match=r"refused: .* a second instance"):
        run(load(path))


def test_patience_counts_for_calls_not_for_the_start(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process that takes twice the patience to start is waited for."""
    limits = Limits(patience=1.5)
    slow = f"import time; time.sleep({2.0 * limits.patience})"
    (tmp_path / "sitecustomize.py").write_text(slow)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    path = shelf("MASS", 2)
    extract(path, tmp_path / "unpacked")
    instance = open_instance("m", read_interface(path), tmp_path / "unpacked", True, limits)
    instance.close()
    assert instance.messages == []


@pytest.mark.parametrize(
    ("isolate", "culprit"), [(True, "m: its process"), (None, "the process of its FMUs")]
)
def test_process_that_cannot_be_started_is_reported(
    isolate: bool | None,
    culprit: str,
    shelf: Shelf,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def full(*arguments: object, **options: object) -> None:
        raise OSError(errno.EMFILE, "Too many open files")

    unit = part("m", shelf("MASS", 2), isolate=isolate)
    plan = load(scenario(tmp_path, unit, hold({"m.force": 0.0})))
    monkeypatch.setattr(subprocess, "Popen", full)
    with pytest.raises(InitialisationError, match=rf"{culprit} cannot be started \(Too many"):
        run(plan)


def test_modules_in_the_folder_of_an_fmu_are_not_imported(shelf: Shelf, tmp_path: Path) -> None:
    """A file of an FMU with the name of a module is not imported by its process."""
    path = tmp_path / "trap.fmu"
    path.write_bytes(shelf("MASS", 2).read_bytes())
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("json.py", "raise SystemExit(7)")
        archive.writestr("orchestrator/__init__.py", "raise SystemExit(7)")
    ran(scenario(tmp_path, part("m", path), hold({"m.force": 0.0})))
