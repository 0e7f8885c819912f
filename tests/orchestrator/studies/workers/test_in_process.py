"""Points in this process: the same records as on workers, interrupts, files that change."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import InputError
from orchestrator.simulation.interrupt import Interrupted
from orchestrator.studies.sweep.study import sweep
from orchestrator.studies.workers import pool
from orchestrator.studies.workers.in_process import InProcess
from orchestrator.studies.workers.task import answered

AXES = ["amplifier.frequency=48,50,52Hz"]


def test_the_same_as_on_workers(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = {"time": {"stop": "5 cycles"}}
    there = sweep("oscillator-1", AXES, native, tmp_path / "there.nc", options=options, workers=1)
    monkeypatch.setattr(pool.WorkerPool, "_opened", lambda *_: pytest.fail("a worker"))
    here = sweep("oscillator-1", AXES, native, tmp_path / "here.nc", options=options)
    for name in ("travel", "frequency", "steps", "status"):
        assert here[name].values.tolist() == there[name].values.tolist()


def test_long_points_get_workers(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Opened(Exception):
        """Workers are asked for."""

    def opened(*_: object) -> None:
        raise Opened

    monkeypatch.setattr(pool.WorkerPool, "_opened", opened)
    options = {"time": {"stop": "50000 cycles"}}
    with pytest.raises(Opened):
        sweep("oscillator-1", AXES, native, tmp_path / "s.nc", options=options)


def test_an_interrupt_is_no_failure_of_a_point() -> None:
    def stopped() -> dict[str, str]:
        raise Interrupted(2)

    with pytest.raises(Interrupted):
        answered(stopped, {})


def test_a_file_that_changes_is_said() -> None:
    with (
        InProcess(lambda point: {"unfit": f"{point} is another one"}) as here,
        pytest.raises(InputError, match="a is another one; it has changed"),
    ):
        list(here.answers(["a"], lambda: None))
