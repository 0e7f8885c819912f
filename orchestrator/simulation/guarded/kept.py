"""What is kept from one run to the next: processes of guarded runs, and unpacked FMUs.

A study starts one process, not one for each run, and unpacks each part once.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenario.plan import Plan
from ..unpacked import keep_folders, kept_folders

if TYPE_CHECKING:
    from .process import GuardedProcess

MOST_JOBS = 100
"""Jobs of one process: each loads the libraries of its FMUs anew, and unloads none."""


@dataclass
class _Kept:
    """Idle processes by what they may be used for, while anybody wants them kept."""

    wanted: int = 0
    idle: dict[Any, GuardedProcess] = field(default_factory=dict)
    lock: threading.Lock = field(default_factory=threading.Lock)


_KEPT = _Kept()


@contextmanager
def kept_between_runs() -> Iterator[None]:
    """Inside, the process of a guarded run waits for another run of the same FMUs.

    FMUs of this project stay unpacked.
    """
    with _KEPT.lock:
        _KEPT.wanted += 1
    try:
        with kept_folders():
            yield
    finally:
        with _KEPT.lock:
            _KEPT.wanted -= 1
            left = [] if _KEPT.wanted else list(_KEPT.idle.values())
            if left:
                _KEPT.idle.clear()
        for process in left:
            process.close()


def keep_between_runs() -> None:
    """From here on to the end of this process, as a worker does; its processes end with it."""
    keep_folders()
    with _KEPT.lock:
        _KEPT.wanted += 1


@contextmanager
def process_for(plan: Plan, *, fresh: bool = False) -> Iterator[GuardedProcess]:
    """A process for a run of a plan: a new one, or one that has run the same FMUs before.

    It is kept afterwards where it is idle and wanted, and FMUs do not ask for a process that has
    had no other instance of them.
    """
    from .process import GuardedProcess

    use = _use(plan)
    with _KEPT.lock:
        found = None if fresh else _KEPT.idle.pop(use, None)
    process = found or GuardedProcess(plan)
    try:
        yield process
    finally:
        once = any(interface.once for interface in plan.interfaces.values())
        spare: GuardedProcess | None = process
        with _KEPT.lock:
            if _KEPT.wanted and process.idle and process.used < MOST_JOBS and not once:
                spare = _KEPT.idle.get(use)
                _KEPT.idle[use] = process
        if spare is not None:
            spare.close()


def _use(plan: Plan) -> Any:
    """What two plans have in common that may use one process one after the other."""
    memory = max(limits.memory for limits in plan.limits.values())
    return Path.cwd(), memory, tuple(sorted(plan.digests.values()))
