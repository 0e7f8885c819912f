"""All cases by all methods on the workers of this machine."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

from ...errors import ScenarioError
from ...scenario.library import LIBRARY, located
from ...simulation.interrupt import Interrupt
from ...simulation.scratch import Scratch
from ..precision.method import Method, methods_for
from ..workers.pool import Failed, WorkerPool
from .cases import Case, plan_of
from .classification import CLASSES, Trial
from .trial import Job, work

PATIENCE = 30.0
"""Seconds that one run may take."""


@dataclass(frozen=True)
class Study:
    """Trials of every case, the name of each case's reference, and the wall time of all [s].

    `memory` is the most that a worker has used [byte].
    """

    cases: list[Case]
    references: dict[str, str]
    trials: list[Trial]
    wall_time: float
    memory: float = 0.0

    def count(self, only: Literal["usual", "auto"] | None = None) -> dict[str, int]:
        """Trials of each class; of the scenarios' own settings, or of the automatic steps alone."""
        found = Counter(t.kind for t in self.trials if only is None or getattr(t, only))
        return {kind: found[kind] for kind in CLASSES}


def stability(
    cases: Sequence[Case],
    file: Path,
    library: Path = LIBRARY,
    *,
    methods: Sequence[Method] | None = None,
    workers: int | None = None,
    patience: float = PATIENCE,
    interrupt: Interrupt | None = None,
    tell: Callable[[int, int], None] | None = None,
) -> Study:
    """Run each case of a file by each method at each of its steps, and class each run.

    The references are solved first. A task is one case by one method; where its worker ends or
    hangs, all trials of that task count as silently wrong. Raises `ScenarioError` with all problems
    of all cases before anything runs.
    """
    begun = perf_counter()
    check = interrupt.check if interrupt is not None else _nothing
    library = located(library, file)
    tried = _planned(cases, file, library, methods)
    with Scratch(file) as folder:
        basis = (file.resolve(), library.resolve(), folder, patience)
        solve = [Job(case, *basis) for case in cases]
        attempt = [Job(case, *basis, method) for case in cases for method in tried[case.name]]
        total = len(solve) + len(attempt)
        references: dict[str, str] = {}
        trials: list[Trial] = []
        memory = 0.0
        with WorkerPool(work, workers, None, patience * 40.0) as pool:
            for done, (job, answer) in enumerate(pool.answers(solve, check), start=1):
                references[job.case.name] = _named(answer)
                (tell or _silent)(done, total)
            answers = pool.answers(attempt, check)
            for done, (job, answer) in enumerate(answers, start=len(solve) + 1):
                trials += _trials(job, answer)
                memory = max(memory, answer.get("memory", 0.0) if isinstance(answer, dict) else 0.0)
                (tell or _silent)(done, total)
    place = {case.name: k for k, case in enumerate(cases)}
    trials.sort(key=lambda t: (place[t.case], t.laws, t.master, t.per_cycle))
    return Study(list(cases), references, trials, perf_counter() - begun, memory)


def _planned(
    cases: Sequence[Case], file: Path, library: Path, methods: Sequence[Method] | None
) -> dict[str, list[Method]]:
    """Methods of each case; `ScenarioError` with everything that is wrong with any of them."""
    problems: list[str] = []
    tried: dict[str, list[Method]] = {}
    for case in cases:
        try:
            plan = plan_of(case, file, library)
        except ScenarioError as error:
            problems += [f"case {case.name}: {text}" for text in error.problems]
            continue
        able = methods_for(plan)
        tried[case.name] = [m for m in methods if m in able] if methods else able
    if problems:
        raise ScenarioError(problems)
    return tried


def _named(answer: dict[str, Any] | Failed) -> str:
    if isinstance(answer, Failed):
        return f"none: {answer.reason}"
    return str(answer.get("reference") or f"none: {answer.get('reason')}")


def _trials(job: Job, answer: dict[str, Any] | Failed) -> list[Trial]:
    """Trials of an answer; without an answer all of them count as silently wrong."""
    if isinstance(answer, dict) and "trials" in answer:
        return [Trial(**trial) for trial in answer["trials"]]
    reason = answer.reason if isinstance(answer, Failed) else str(answer.get("reason"))
    method = job.method or Method("", "")
    return [
        Trial(job.case.name, method.kind, method.laws, n, "silent", reason=reason)
        for n in job.case.per_cycle
    ]


def _nothing() -> None:
    """Check for no interrupts."""


def _silent(done: int, total: int) -> None:
    """Show no progress."""
