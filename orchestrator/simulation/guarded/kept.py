"""What is kept from one run to the next: processes of guarded runs, and unpacked FMUs.

A study starts one process, not one for each run, and unpacks each part once.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenario.plan import Plan
from ...scenario.processes import shared_memory
from ..kept import Kept
from ..unpacked import FOLDERS

if TYPE_CHECKING:
    from .process import GuardedProcess

MOST_JOBS = 100
"""Jobs of one process: each loads the libraries of its FMUs anew, and unloads none."""


_PROCESSES: Kept[GuardedProcess] = Kept(lambda process: process.close())
"""Idle processes, by what they may be used for."""


@contextmanager
def kept_between_runs() -> Iterator[None]:
    """Inside, the process of a guarded run waits for another run of the same FMUs.

    FMUs of this project stay unpacked.
    """
    with _PROCESSES.inside(), FOLDERS.inside():
        yield


def keep_between_runs() -> None:
    """From here on to the end of this process, as a worker does; its processes end with it."""
    _PROCESSES.keep()
    FOLDERS.keep()


@contextmanager
def process_for(plan: Plan, *, fresh: bool = False) -> Iterator[GuardedProcess]:
    """A process for a run of a plan: a new one, or one that has run the same FMUs before.

    It is kept afterwards where it is idle and wanted, and FMUs do not ask for a process that has
    had no other instance of them.
    """
    from .process import GuardedProcess

    use = _use(plan)
    with _PROCESSES.lock:
        found = None if fresh else _PROCESSES.things.pop(use, None)
    process = found or GuardedProcess(plan)
    try:
        yield process
    finally:
        once = any(interface.once for interface in plan.interfaces.values())
        spare: GuardedProcess | None = process
        with _PROCESSES.lock:
            if _PROCESSES.wanted and process.idle and process.used < MOST_JOBS and not once:
                spare = _PROCESSES.things.get(use)
                _PROCESSES.things[use] = process
        if spare is not None:
            spare.close()


def _use(plan: Plan) -> Any:
    """What two plans have in common that may use one process one after the other."""
    return Path.cwd(), shared_memory(plan), tuple(sorted(plan.digests.values()))
