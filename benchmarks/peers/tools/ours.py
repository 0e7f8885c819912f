"""Our masters through the public interface: `load` and `run`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

from ..case import Case
from .base import March, Method, Tool, Track, importable


class Ours(Tool):
    """Sequential, parallel and extrapolating master. Loading is inside `run`, which
    also reports the time of stepping alone: that time counts."""

    name = "ours"
    distribution = "resilin"
    install = "pip install -e ."
    methods = (
        Method("gauss-seidel"),
        Method("jacobi"),
        Method("extrapolated", ("values",)),
    )

    def missing(self) -> str:
        return importable("orchestrator")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from orchestrator import run

        from ..wiring import plan_of

        plan = plan_of(
            case.scenario, Path(case.library), case.wiring, case.per_cycle, case.cycles, method,
            every=case.every,
        )  # fmt: skip
        names = [f"{w.component}.{w.name}" for w in case.watched]

        def march() -> Track:
            begun = perf_counter()
            outcome = run(plan, estimate=False)
            if outcome.failure is not None:
                raise outcome.failure
            track = Track(
                [float(t) for t in outcome.times[1:]],
                [[float(outcome.series(n)[k]) for n in names] for k in range(1, outcome.kept)],
                sum(outcome.calls.values()),
            )
            track.aside = perf_counter() - begun - outcome.wall_time
            return track

        yield march
