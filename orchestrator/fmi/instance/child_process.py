"""What a process in which FMUs run does first: its pipes, and the limit of its memory."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from ...errors import printable
from .protocol import Gone


def serve_pipes(serve: Callable[[int, int], None]) -> NoReturn:
    """Serve by the pipes that were the standard streams, until they end; then leave.

    `serve` gets their descriptors, for commands and for answers. What an FMU prints goes to
    standard error, and it finds nothing to read. The exit code is 3 where anything else is raised
    than that the pipe is gone; nothing of the FMUs is unloaded on the way out.
    """
    commands, answers = os.dup(0), os.dup(1)
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.dup2(2, 1)
    try:
        serve(commands, answers)
    except Gone:
        pass
    except BaseException as error:
        print(printable(repr(error)), file=sys.stderr, flush=True)
        os._exit(3)
    os._exit(0)


def limit_memory(most: int) -> None:
    """Limit what FMUs may allocate beyond what is in use [byte]; no core files."""
    try:
        import resource
    except ImportError:
        return
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if sys.platform == "linux" else 0
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    limit = min(pages * resource.getpagesize() + most, sys.maxsize)
    if hard == resource.RLIM_INFINITY or limit < hard:
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
