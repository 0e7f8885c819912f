"""Processes that tests start: signals as a terminal leaves them, waits that end on an event."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator

import psutil

MARK = "RESILIN_TEST_MARK"
"""Name in the environment by which the processes of one test are known."""
REACHED = "RESILIN_TEST_REACHED"
"""Name in the environment of the file that FAULTY makes when its fault_time is reached."""
HOSTS = {"orchestrator.fmi.instance.isolated_child", "orchestrator.simulation.guarded.child"}
POLL = 0.02
LAUNCHER = """
import os, signal, sys
for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT"):
    ignored = name in sys.argv[1].split(",")
    signal.signal(getattr(signal, name), signal.SIG_IGN if ignored else signal.SIG_DFL)
signal.pthread_sigmask(signal.SIG_SETMASK, ())
os.execvp(sys.argv[2], sys.argv[2:])
"""


def fresh(*command: object, ignored: Iterable[str] = ()) -> list[str]:
    """A command line that resets the signals that whoever runs the tests ignores or blocks.

    A shell ignores SIGINT for its jobs in the background, nohup ignores SIGHUP, and children
    inherit that. The command takes the place of the launcher and so keeps its process number.
    """
    launcher = [sys.executable, "-I", "-S", "-c", LAUNCHER, ",".join(ignored)]
    return [*launcher, *(str(word) for word in command)]


def python(*arguments: object, ignored: Iterable[str] = ()) -> list[str]:
    """This interpreter with fresh signals."""
    return fresh(sys.executable, *arguments, ignored=ignored)


def resilin(*arguments: object, ignored: Iterable[str] = ()) -> list[str]:
    """The command with fresh signals."""
    return python("-m", "orchestrator.cli", *arguments, ignored=ignored)


@contextlib.contextmanager
def started(command: list[str], **environment: str) -> Iterator[subprocess.Popen[str]]:
    """A process at the head of a session of its own, killed with its group in the end."""
    process = subprocess.Popen(
        command,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def until(condition: Callable[[], object], process: subprocess.Popen[str] | None = None) -> None:
    """Wait for an event; only pytest's own limit on a test ends a wait in vain.

    Where a process brings the event about, its end without it is a failure.
    """
    while not condition():
        if process is not None and process.poll() is not None and not condition():
            raise AssertionError(f"ended with {process.returncode}: {process.communicate()}")
        time.sleep(POLL)


@contextlib.contextmanager
def when(condition: Callable[[], object], act: Callable[[], object]) -> Iterator[None]:
    """Do something once a condition holds, beside the test; it must hold in the end."""
    over = threading.Event()
    done: list[bool] = []

    def watch() -> None:
        while not (held := condition()) and not over.wait(POLL):
            continue
        if held or condition():
            act()
            done.append(True)

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
    assert done, "what was waited for did not happen"


def marked(word: str) -> list[psutil.Process]:
    """Living processes other than this one with a mark in their environment."""
    processes = psutil.process_iter(["environ"])
    return [
        process
        for process in processes
        if (process.info["environ"] or {}).get(MARK) == word and process.pid != os.getpid()
    ]


def hosts(word: str) -> list[psutil.Process]:
    """Those of them that are the processes of guarded runs and isolated instances."""
    return [process for process in marked(word) if HOSTS & {*_command(process)}]


def _command(process: psutil.Process) -> list[str]:
    try:
        words: list[str] = process.cmdline()
    except psutil.Error:
        return []
    return words


def dead_children() -> set[int]:
    """Children of this process that have ended and that nobody has asked for their end."""
    found = set()
    for child in psutil.Process().children():
        with contextlib.suppress(psutil.NoSuchProcess):
            if child.status() == psutil.STATUS_ZOMBIE:
                found.add(child.pid)
    return found
