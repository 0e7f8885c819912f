"""What a process in which FMUs run does first: its pipes, and the limit of its memory."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def take_pipes() -> tuple[int, int]:
    """Descriptors of the pipes that were the standard streams.

    What an FMU prints goes to standard error from then on, and it finds nothing to read.
    """
    commands, answers = os.dup(0), os.dup(1)
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.dup2(2, 1)
    return commands, answers


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
