"""Where jobs are run: each once, on the workers there are, and not again while nothing changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from ...scenario.library import located
from ..run_cache import RunCache
from ..workers.pool import Failed, WorkerPool
from .job import Answer, Job, answer_of, carry_out, identity, plan_of

Task = tuple[Job, str, str]
BEYOND = 4.0 / 3.0
"""Error over the distance to the half step, for second order.

See `orchestrator.results.error_estimate`.
"""


@dataclass(frozen=True)
class Measured:
    """A value of a run, how wrong the stepping makes it (in its unit), and the time it took."""

    value: float
    doubt: float
    wall_time: float
    reason: str = ""


class CachedRuns:
    """Answers to jobs, from the cache where they are known, else from workers.

    A context manager: workers start with the first job that is not known, and end with it.
    `progress` is called with the jobs done and the jobs asked for; `check` may raise to stop.
    """

    def __init__(
        self,
        library: Path,
        cache: RunCache,
        workers: int | None = None,
        check: Callable[[], None] | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> None:
        self.library = located(library).absolute()
        self._cache = cache
        self._pool: WorkerPool[Task] = WorkerPool(carry_out, workers)
        self._check = check or (lambda: None)
        self._progress = progress or (lambda done, asked: None)
        self._known: dict[str, Answer] = {}
        self._checked: set[str] = set()
        self.ran = 0
        self._asked = 0

    def __enter__(self) -> Self:
        self._cache.prepare()
        self._pool.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.__exit__(*_)

    def answers(self, jobs: Sequence[Job]) -> list[Answer]:
        """The answer to each job, in their order."""
        keys = [identity(job, self.library) for job in jobs]
        waiting: dict[str, Task] = {}
        for job, key in zip(jobs, keys, strict=True):
            if key in self._known or key in waiting:
                continue
            if (found := self._cached(key)) is not None:
                self._known[key] = found
            else:
                waiting[key] = (job, str(self.library), key)
        self._look_through(waiting)
        self._asked += len(waiting)
        for (_, _, key), content in self._pool.answers(waiting.values(), self._check):
            if isinstance(content, Failed):
                self._known[key] = Answer("failed", content.reason)
            else:
                self._cache.write(key, content)
                self._known[key] = answer_of(content)
            self.ran += 1
            self._progress(self.ran, self._asked)
        return [self._known[key] for key in keys]

    def _cached(self, key: str) -> Answer | None:
        """The cached answer; None where there is none of the shape of today."""
        try:
            found = self._cache.read(key)
            return None if found is None else answer_of(found)
        except (ValueError, KeyError, TypeError, AttributeError):
            return None

    def measured(self, job: Job, measure: Callable[[Answer], float]) -> Measured:
        """A number of a job, and its distance from that at half the step, widened to an error."""
        half = job.halved()
        coarse, *finer = self.answers([job] if half is None else [job, half])
        if coarse.status != "done":
            return Measured(float("nan"), float("nan"), coarse.wall_time, coarse.reason)
        value = measure(coarse)
        doubts = [BEYOND * abs(value - measure(fine)) for fine in finer if fine.status == "done"]
        return Measured(value, max(doubts, default=float("nan")), coarse.wall_time)

    def _look_through(self, waiting: dict[str, Task]) -> None:
        """Check a plan of each scenario here, where an error is one line for the user."""
        for job, _, _ in waiting.values():
            if job.scenario not in self._checked:
                plan_of(job, self.library)
                self._checked.add(job.scenario)
