"""The master's end of a guarded run: it watches, and keeps every row whatever the process does."""

from __future__ import annotations

from collections.abc import Sequence

from ...results.outcome import Outcome
from ...results.segments import Segments
from ...scenario.plan import Plan
from ..interrupt import Interrupt
from ..observers import Progress
from .job import Job
from .kept import process_for
from .watch import EndedInProbe, Spoiled, Watch


def run_guarded(
    plan: Plan,
    points: Sequence[float] | None,
    *,
    progress: bool = False,
    interrupt: Interrupt | None = None,
    segments: Segments | None = None,
) -> Outcome:
    """Step a plan in a process of its own, over its own points or given ones.

    The same outcome as in this process. A crash, an exit, a hang or full memory ends that process
    alone: the outcome's failure names the instance, the call, the time and how the process ended,
    and every row up to it is kept. Raises `InitialisationError` where that comes before the first
    step, and what the system itself raises.
    """
    bar = Progress(plan) if progress else None

    def attempt(*, fresh: bool, probe: bool) -> Outcome:
        with process_for(plan, fresh=fresh) as process:
            job = Job(plan, points, process.files, segments is not None, probe)
            process.carry_out(job)
            return Watch(job, process, segments=segments, interrupt=interrupt, bar=bar).outcome()

    def sure(*, probe: bool) -> Outcome:
        try:
            return attempt(fresh=False, probe=probe)
        except Spoiled:
            return attempt(fresh=True, probe=probe)

    try:
        return sure(probe=True)
    except EndedInProbe:
        return sure(probe=False)
    finally:
        if bar is not None:
            bar.close()
