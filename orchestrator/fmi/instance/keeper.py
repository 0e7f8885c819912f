"""What ends the processes of isolated instances where their master is gone, however it ended.

One small process for each master, while it has isolated instances: it reads their process groups
from a pipe and, where the pipe ends without taking them back, kills them and removes their folders.
An instance that does not let go of the interpreter, or forks, cannot prevent that.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

PROGRAM = """
import os, signal, sys
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
groups = {}
for line in sys.stdin.buffer:
    number, _, folder = line.rstrip(b"\\n").partition(b" ")
    if int(number) > 0:
        groups[int(number)] = folder
    else:
        groups.pop(-int(number), None)
for group, folder in groups.items():
    try:
        os.killpg(group, signal.SIGKILL)
    except OSError:
        pass
    if folder:
        import shutil
        shutil.rmtree(folder, ignore_errors=True)
"""


class Keeper:
    """The process, started with the first group and ended with the last; thread-safe."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._groups: set[int] = set()
        self._lock = threading.Lock()

    def add(self, group: int, folder: Path | None = None) -> None:
        """Watch over a process group and the folder that it works in.

        Raises `OSError` where the process cannot be started.
        """
        with self._lock:
            if self._process is None:
                self._process = subprocess.Popen(
                    [sys.executable, "-I", "-S", "-c", PROGRAM],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    start_new_session=True,
                    bufsize=0,
                )
                atexit.register(self._end)
            self._groups.add(group)
            self._tell(b"%d" % group + (b" " + os.fsencode(folder) if folder else b""))

    def remove(self, group: int) -> None:
        """Leave a group alone, which has ended."""
        with self._lock:
            self._groups.discard(group)
            self._tell(b"%d" % -group)
            if not self._groups:
                self._end()

    def _tell(self, line: bytes) -> None:
        if self._process is not None and self._process.stdin is not None:
            with suppress(OSError):
                self._process.stdin.write(line + b"\n")

    def _end(self) -> None:
        process, self._process = self._process, None
        atexit.unregister(self._end)
        if process is not None and process.stdin is not None:
            process.stdin.close()
            process.wait()


KEEPER: Keeper | None = Keeper() if hasattr(os, "killpg") else None
