"""What a number of a run depends on: d ln(measure)/d ln(parameter) by central differences."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from .cached_runs import CachedRuns
from .job import Answer, Job, plan_of, start_of

SHARE = 0.02
"""Change of a parameter to either side: far above the steps' error, far below a bend."""

FILM = {
    "permittivity": "spring.permittivity",
    "loss factor": "spring.loss_factor",
    "moving mass of the films": "payload.film_mass",
    "resistance": "amplifier.resistance",
}
"""Parameters of an oscillator that were fitted or assumed, by their names in words."""


def sensitivities(
    cached_runs: CachedRuns,
    jobs: Sequence[Job],
    measure: Callable[[Answer], float],
    parameters: Mapping[str, str] = FILM,
) -> list[dict[str, float]]:
    """For each job d ln(measure)/d ln(p) of each parameter, by its words; NaN where a run stops."""
    changed = [
        _changed(cached_runs, job, key, sign) for job in jobs for key in parameters.values()
        for sign in (-1.0, 1.0)
    ]  # fmt: skip
    answers = cached_runs.answers(changed)
    values = [measure(a) if a.status == "done" else math.nan for a in answers]
    wide = math.log((1.0 + SHARE) / (1.0 - SHARE))
    slopes = [
        math.log(high / low) / wide for low, high in zip(values[::2], values[1::2], strict=True)
    ]
    count = len(parameters)
    return [
        dict(zip(parameters, slopes[k * count : (k + 1) * count], strict=True))
        for k in range(len(jobs))
    ]


def in_words(slopes: Mapping[str, float]) -> str:
    """Sensitivities in words, for a sentence on 1 % more of each."""
    return ", ".join(f"{name} {slope:+.2f} %" for name, slope in slopes.items())


def _changed(cached_runs: CachedRuns, job: Job, key: str, sign: float) -> Job:
    value = start_of(plan_of(job, cached_runs.library), key) * (1.0 + sign * SHARE)
    return replace(job, changes={**job.changes, key: repr(value)})
