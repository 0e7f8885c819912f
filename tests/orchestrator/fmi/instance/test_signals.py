"""Signals to a master with an isolated instance: rows are kept, no process is left."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest
import xarray

from orchestrator.simulation.load import load
from orchestrator.simulation.system import System
from tests.foreign.scenarios import Shelf, faulty
from tests.processes import REACHED, hosts, marked, resilin, started, until, when

pytestmark = pytest.mark.usefixtures("mark")


@contextmanager
def begun(
    path: Path, ignored: tuple[str, ...] = (), temporary: str = ""
) -> Iterator[subprocess.Popen[str]]:
    """A run as a process of its own, begun so far that its FAULTY has reached fault_time."""
    reached = path.parent / "reached"
    command = resilin("run", path, "--output", path.parent / "out.nc", ignored=ignored)
    places = {"TMPDIR": temporary or tempfile.gettempdir(), REACHED: str(reached)}
    with started(command, **places) as master:
        until(reached.exists, master)
        yield master


@pytest.mark.parametrize("fault", [0, 2], ids=["busy", "hanging"])
def test_isolated_process_ends_with_its_killed_master(
    fault: int, shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    """The folder for temporary files goes too: the keeper removes it."""
    (tmp_path / "kept").mkdir()
    path = faulty(tmp_path, shelf("FAULTY", 2), fault, stop=5e6, patience="600 s")
    with begun(path, temporary=str(tmp_path / "kept")) as master:
        assert len(hosts(mark)) == 1
        master.kill()
        master.wait()
        until(lambda: marked(mark) == [])
    assert list((tmp_path / "kept").iterdir()) == []


@pytest.mark.parametrize(
    ("ignored", "number"),
    [
        ((), signal.SIGINT),
        ((), signal.SIGTERM),
        (("SIGINT",), signal.SIGTERM),
        (("SIGINT",), signal.SIGHUP),
        (("SIGINT", "SIGHUP"), signal.SIGTERM),
    ],
    ids=["interrupt", "end", "end in the background", "hangup in the background", "end of nohup"],
)
def test_signal_to_the_whole_group_keeps_the_rows(
    ignored: tuple[str, ...], number: signal.Signals, shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    """Whatever the parent ignores: an ignored signal that comes before does nothing."""
    path = faulty(tmp_path, shelf("FAULTY", 3), 0, stop=5e6)
    with begun(path, ignored) as master:
        for name in ignored:
            os.killpg(master.pid, signal.Signals[name])
        os.killpg(master.pid, number)
        _, stderr = master.communicate()
        assert marked(mark) == []
    assert master.returncode == 128 + number
    (line,) = stderr.splitlines()
    assert line.startswith(f"resilin: stopped by {number.name}; ")
    with xarray.open_dataset(tmp_path / "out.partial.nc") as data:
        assert data.attrs["complete"] == 0
        assert data.sizes["time"] > 1


def test_master_that_is_stopped_and_continued_keeps_its_instance(
    shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    """The time of the stop does not count as patience, and the instance goes on working."""
    patience = 2.0
    path = faulty(tmp_path, shelf("FAULTY", 2), 0, stop=5e6, patience=f"{patience} s")

    def worked() -> float:
        return sum(host.cpu_times().user for host in hosts(mark))

    with begun(path) as master:
        master.send_signal(signal.SIGSTOP)
        until(lambda: psutil.Process(master.pid).status() == psutil.STATUS_STOPPED)
        threading.Event().wait(2.0 * patience)
        before = worked()
        master.send_signal(signal.SIGCONT)
        until(lambda: worked() > before + 0.2, master)
        master.send_signal(signal.SIGINT)
        assert "stopped by SIGINT" in master.communicate()[1]


@pytest.mark.parametrize(
    ("number", "count"), [(signal.SIGTERM, 1), (signal.SIGINT, 2), (signal.SIGTERM, 2)]
)
def test_signal_ends_a_hanging_instance_and_keeps_the_rows(
    number: signal.Signals, count: int, shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    """After some seconds of grace, or at once with a second signal, whatever the patience.

    Two at once count as one: then the grace counts.
    """
    path = faulty(tmp_path, shelf("FAULTY", 2), 2, patience="600 s")
    with begun(path) as master:
        for _ in range(count):
            master.send_signal(number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                master.wait(0.5)
        _, stderr = master.communicate()
        until(lambda: marked(mark) == [])
    assert master.returncode == 128 + number
    (line,) = stderr.splitlines()
    assert line.startswith(f"resilin: stopped by {number.name}; ")
    with xarray.open_dataset(tmp_path / "out.partial.nc") as data:
        assert data.sizes["time"] > 1


def test_interrupt_amid_a_call_closes_all(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reached = tmp_path / "reached"
    monkeypatch.setenv(REACHED, str(reached))
    path = faulty(tmp_path, shelf("FAULTY", 2), 2, patience="600 s")

    def struck(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    main = threading.main_thread().ident or 0
    before = signal.signal(signal.SIGUSR1, struck)
    try:
        with (
            when(reached.exists, lambda: signal.pthread_kill(main, signal.SIGUSR1)),
            pytest.raises(KeyboardInterrupt),
            System(load(path)) as system,
        ):
            system.instances[0].instance.step(0.0, 1.0)
        system.close()
    finally:
        signal.signal(signal.SIGUSR1, before)
