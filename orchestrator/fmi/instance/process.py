"""Processes in which FMUs run: started, watched over by the keeper, and ended for certain."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import uuid
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...errors import printable
from .keeper import KEEPER

KEPT_OUTPUT = 4000
"""Bytes that are kept of what a process prints."""
MARK = "RESILIN_PROCESS"
_MARKS: dict[int, str] = {}
CLOSING_TIME = 2.0
"""Seconds that an instance gets to terminate and free itself at the end."""


def started(
    module: str,
    folder: Path,
    *,
    pass_fds: Sequence[int] = (),
    scratch: Path | None = None,
) -> subprocess.Popen[bytes]:
    """A process for FMUs, which imports this package from where this process has it.

    It leads a group of its own, which ends with this process, however this one ends; `scratch`,
    where its temporary files go, is removed then. What it starts carries a mark in its environment,
    by which `ended` finds those that have left the group. Raises `OSError`.
    """
    here = str(Path(__file__).resolve().parents[3])
    path = os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH", "")]))
    temporary = {"TMPDIR": str(scratch)} if scratch is not None else {}
    mark = uuid.uuid4().hex
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", module],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=folder,
        env={**os.environ, **temporary, "PYTHONPATH": path, MARK: mark},
        pass_fds=pass_fds,
        start_new_session=True,
    )
    if KEEPER is not None:
        try:
            KEEPER.add(process.pid, scratch)
        except OSError:
            kill(process)
            process.wait()
            raise
    _MARKS[process.pid] = mark
    return process


def kill(process: subprocess.Popen[bytes]) -> None:
    """Kill a process and what it has started, unless it has been reaped: its group is its own."""
    if process.returncode is None:
        with suppress(ProcessLookupError):
            if hasattr(os, "killpg"):
                os.killpg(process.pid, signal.SIGKILL)
            else:
                process.kill()


def ended(process: subprocess.Popen[bytes]) -> int:
    """Exit code of a process, waited for; what it has started and left behind is killed.

    Until it is reaped the number of its group cannot be that of another.
    """
    if process.returncode is None and hasattr(os, "waitid"):
        with suppress(ChildProcessError):
            os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        kill(process)
    code = process.wait()
    _kill_marked(_MARKS.pop(process.pid, ""))
    if KEEPER is not None:
        KEEPER.remove(process.pid)
    return code


def _kill_marked(mark: str) -> None:
    """Kill every process with a mark in its environment, where the system shows that."""
    sought = f"{MARK}={mark}".encode()
    for place in Path("/proc").glob("[0-9]*/environ") if mark else ():
        with suppress(OSError):
            if sought in place.read_bytes().split(b"\0"):
                os.kill(int(place.parent.name), signal.SIGKILL)


def largest_child() -> float:
    """Most memory [byte] that any ended child of this process had; 0 where it is unknown."""
    try:
        import resource
    except ImportError:
        return 0.0
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    return most * (1.0 if sys.platform == "darwin" else 1024.0)


def dispose(process: subprocess.Popen[bytes], tail: Tail) -> None:
    """Kill a process with all that it has started, and close what led to it."""
    kill(process)
    ended(process)
    tail.stop()
    for stream in (process.stdin, process.stdout):
        with suppress(OSError):
            stream.close()  # type: ignore[union-attr]


def no_answer(patience: float) -> str:
    """How a process ended that was stopped amid a call, after so many seconds."""
    return f"no answer within {patience:g} s; its process was stopped"


def how_it_ended(code: int, memory: int) -> str:
    """How a process ended by itself: with which signal or exit code, and whether memory ran out.

    `memory` is what it was allowed [byte].
    """
    if code < 0:
        names = {entry.value: entry.name for entry in signal.Signals}
        end = f"its process was ended by {names.get(-code, f'signal {-code}')}"
    else:
        end = f"its process ended with exit code {code}"
    if largest_child() > 0.9 * memory:
        end += f", probably out of memory: its limit is {memory / 1e6:.4g} MB"
    return end


class Tail:
    """Reads what a process prints, however much, and keeps the end."""

    def __init__(self, stream: Any) -> None:
        self._kept = b""
        self._stream = stream
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        with self._stream as stream:
            while chunk := os.read(stream.fileno(), 1 << 16):
                self._kept = (self._kept + chunk)[-KEPT_OUTPUT:]

    def behind(self, end: str) -> str:
        """How a process ended, and the last line that it printed, safe to print."""
        self._thread.join(0.5)
        lines = self._kept.decode("utf-8", "replace").split("\n")
        last = [line.strip() for line in lines if line.strip()][-1:]
        return f"{end}; its last output: {printable(last[0], most=300)}" if last else end

    def stop(self) -> None:
        self._thread.join(CLOSING_TIME)
