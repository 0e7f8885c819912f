"""Workers that crash, hang, are killed, start slowly or not at all."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

import dask
import numpy as np
import pytest
import xarray
from distributed import LocalCluster
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError, SimulationError
from orchestrator.studies.sweep.points import Setting, calculate, planned
from orchestrator.studies.sweep.study import Axis, parse_axis
from orchestrator.studies.workers import dask_cluster, pool
from orchestrator.studies.workers.pool import WorkerPool
from tests.foreign.build import foreign
from tests.orchestrator.studies.sweeps import SCENARIO, SHORT, STROKE, Sweep, files, ok
from tests.processes import when

WITH_FAULTY = f"""
extends = "{SCENARIO}"
[master]
order = ["amplifier", "actuator", "aero", "linkage", "faulty"]
[components.faulty]
fmu = "faulty.fmu"
isolate = false
start = {{ fault_time = "20 ms" }}
[hold]
"faulty.u" = 1
[record]
variables = ["faulty.y"]
"""
CRASH, HANG, NAN, ERROR = "1", "2", "3", "9"
HEALTHY = ("0", "11", "12", "17")
"""Faults that have no effect in FMI 2."""


@pytest.fixture
def with_faulty(tmp_path: Path) -> Path:
    """The flapping scenario and an instance that fails on demand, in the worker's own process."""
    foreign("FAULTY", tmp_path)
    path = tmp_path / "with-faulty.toml"
    path.write_text(WITH_FAULTY)
    return path


class Patience(float):
    """A patience that is at its end once a number of points is on disk, and not before or after."""

    def __new__(cls, seconds: float, *_: object) -> Self:
        return super().__new__(cls, seconds)

    def __init__(self, seconds: float, target: Path, points: int) -> None:
        self.target, self.points = target, points

    def __lt__(self, spent: float) -> bool:
        return len(files(self.target)) == self.points


def test_a_point_that_fails_fails_alone(swept: Sweep, with_faulty: Path, tmp_path: Path) -> None:
    """A crash, a hang, a NaN and an error, between healthy neighbours.

    The hang lasts until all others are known but the crash, which is tried again when it is over.
    """
    target = tmp_path / "out.nc"
    reasons = {
        HEALTHY[0]: "",
        CRASH: "ended twice",
        HEALTHY[1]: "",
        HANG: "no answer within 3 s",
        HEALTHY[2]: "",
        NAN: "not a finite number",
        HEALTHY[3]: "",
        ERROR: "faulty: step",
    }
    axis = f"faulty.fault={','.join(reasons)}"
    data = swept(axis, scenario=with_faulty, target=target, patience=Patience(3.0, target, 6))
    rising = [reasons[fault] for fault in sorted(reasons, key=int)]
    healthy = np.array([not reason for reason in rising])
    assert list(data["status"].values) == list(np.where(healthy, "done", "failed"))
    assert (np.isfinite(data[STROKE].values) == healthy).all()
    for reason, expected in zip(data["reason"].values, rising, strict=True):
        assert expected in reason and bool(expected) == bool(reason)
    with xarray.open_dataset(target) as read:
        assert read.attrs["complete"] == 1
        assert list(read["reason"].values) == list(data["reason"].values)


def test_a_sweep_with_failed_points_leaves_with_an_error(
    with_faulty: Path, library: Path, tmp_path: Path
) -> None:
    target = tmp_path / "out.nc"
    options = ["--fmus", str(library), "--output", str(target), "--workers", "1", "--quiet"]
    axis = f"faulty.fault={HEALTHY[0]},{ERROR}"
    done = CliRunner().invoke(app, ["sweep", str(with_faulty), "--over", axis, *options])
    assert done.exit_code == 1, done.output
    assert f"1 of 2 points failed; {target} holds the reasons" in done.output.replace("\n", " ")


def test_a_worker_that_is_killed_costs_nothing(cluster: Any, swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    victim = next(iter(cluster.workers.values())).pid
    with when(lambda: len(files(target)) > 1, lambda: os.kill(victim, signal.SIGKILL)):
        data = swept("amplifier.frequency=14:22/15Hz", target=target, keep=True)
    assert set(data["status"].values) == {"done"}


class Mortal:
    """A task that ends its worker once, and what the next one does before it registers."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, preload: str) -> None:
        self.ended = folder / "ended"
        (folder / "preload.py").write_text(
            f"import os, time\nif os.path.exists({str(self.ended)!r}):\n    {preload}\n"
        )
        preloads = [*dask_cluster.PRELOADED, str(folder / "preload.py")]
        monkeypatch.setattr(dask_cluster, "PRELOADED", preloads)
        monkeypatch.setattr(pool, "LOOK", 0.05)
        monkeypatch.setattr(pool, "DESERTED", 2)
        monkeypatch.setattr(pool, "STARTS", 1)

    def answers(self, *points: int) -> list[tuple[int, Any]]:
        """Answers of points, on one worker of a cluster that dask would give up at once."""
        ended = str(self.ended)

        def task(point: int) -> dict[str, Any]:
            import os
            from pathlib import Path

            if not os.path.exists(ended):  # noqa: PTH110
                Path(ended).touch()
                os._exit(1)
            return {"twice": 2 * point}

        hasty = dask.config.set({"distributed.deploy.lost-worker-timeout": 0})
        with hasty, WorkerPool(task, 1) as workers:
            return list(workers.answers(points, ok))


def test_a_worker_that_starts_slowly_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is looked for far more often than where no worker is left."""
    gate = tmp_path / "gate"
    looked = 0
    ask = dask_cluster.starting

    def looking(client: Any, nannies: Any) -> dict[str, int | None]:
        nonlocal looked
        looked += 1
        if looked > 10 * pool.DESERTED:
            gate.touch()
        return ask(client, nannies)

    monkeypatch.setattr(dask_cluster, "starting", looking)
    waits = f"while not os.path.exists({str(gate)!r}): time.sleep(0.02)"
    found = Mortal(tmp_path, monkeypatch, waits).answers(1, 2)
    assert dict(found) == {1: {"twice": 2}, 2: {"twice": 4}}
    assert gate.exists()


def test_workers_that_end_before_they_report_are_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(SimulationError, match=r"2 worker processes ended one after the other"):
        Mortal(tmp_path, monkeypatch, "os._exit(3)").answers(1, 2)


def test_a_scheduler_without_workers_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "LOOK", 0.01)
    monkeypatch.setattr(pool, "DESERTED", 2)
    made: Any = LocalCluster
    with (
        made(
            n_workers=0,
            host="127.0.0.1",
            scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
        ) as own,
        WorkerPool(str, None, own.scheduler_address) as workers,
        pytest.raises(SimulationError, match=r"no worker has been there .* none is being"),
    ):
        list(workers.answers([1], ok))


def test_workers_with_other_files_are_reported(cluster: Any, library: Path, tmp_path: Path) -> None:
    """An FMU that changes between planning and running is not run."""
    own = tmp_path / "fmus"
    own.mkdir()
    for path in library.glob("*.fmu"):
        (own / path.name).write_bytes(path.read_bytes())
    setting = Setting(SCENARIO, str(own), {}, SHORT)
    points = planned(setting, [parse_axis("amplifier.frequency=17,18Hz")], ok).points
    with (own / "spring.fmu").open("ab") as file:
        file.write(b" ")
    workers = WorkerPool(calculate, None, cluster.scheduler_address, None)
    with workers, pytest.raises(InputError, match=r"worker tcp.*other FMU files.*same place"):
        list(workers.answers(points, ok))
    (own / "spring.fmu").unlink()
    assert "spring" in calculate(points[0])["unfit"]
    whole = planned(
        Setting(SCENARIO, str(library), {}, SHORT), [Axis("linkage.damping", ("1",))], ok
    )
    assert "install the same" in calculate(replace(whole.points[0], release="9.9"))["unfit"]
