"""What isolated instances have started ends with them, and they end with their master."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import psutil

from orchestrator.fmi.instance.keeper import Keeper
from orchestrator.fmi.instance.process import ended
from tests.processes import fresh, marked, python, started, until

STUBBORN = "trap '' TERM INT HUP; sleep 600 & sleep 600 & echo ready; "


def alive(group: int) -> list[psutil.Process]:
    """Processes of a group that have not ended."""
    found = []
    for process in psutil.process_iter(["status"]):
        try:
            if os.getpgid(process.pid) == group and process.info["status"] != psutil.STATUS_ZOMBIE:
                found.append(process)
        except ProcessLookupError:
            continue
    return found


def stubborn(end: str) -> subprocess.Popen[bytes]:
    process = subprocess.Popen(
        fresh("sh", "-c", STUBBORN + end), stdout=subprocess.PIPE, start_new_session=True
    )
    assert process.stdout is not None
    process.stdout.readline()
    return process


def test_what_an_ended_process_has_started_is_ended() -> None:
    """The code is that of the process, not of the signal that came after it."""
    for end, code in (("exit 3", 3), ("kill -SEGV $$", -signal.SIGSEGV)):
        process = stubborn(end)
        assert ended(process) == code
        until(lambda group=process.pid: not alive(group))  # type: ignore[misc]
        process.stdout.close()  # type: ignore[union-attr]


def test_groups_end_with_a_master_that_is_killed(mark: str, tmp_path: Path) -> None:
    """Whatever they ignore; nothing of the keeper stays either."""
    code = f"""
import subprocess, sys, time
from orchestrator.fmi.instance.keeper import Keeper
process = subprocess.Popen(["sh", "-c", {STUBBORN!r} + "wait"], start_new_session=True)
keeper = Keeper()
keeper.add(process.pid)
open({str(tmp_path / "ready")!r}, "w").close()
time.sleep(600)
"""
    with started(python("-c", code)) as master:
        until(lambda: (tmp_path / "ready").exists(), master)
        until(lambda: len(marked(mark)) >= 5, master)
        master.kill()
        master.wait()
        until(lambda: marked(mark) == [])


def test_a_keeper_lives_as_long_as_there_are_groups(mark: str) -> None:
    keeper = Keeper()
    first, second = stubborn("wait"), stubborn("wait")
    keeper.add(first.pid)
    keeper.add(second.pid)
    keeper.remove(first.pid)
    assert len(psutil.Process().children()) >= 3
    keeper.remove(second.pid)
    for process in (first, second):
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        process.stdout.close()  # type: ignore[union-attr]
