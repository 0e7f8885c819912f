"""How wrong a run is: its distance from the same run at half its communication steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .metrics import metrics
from .outcome import Estimate, Outcome, whole
from .recorded import Recorded, recorded

Values = NDArray[np.float64]

BEYOND = 4.0 / 3.0
"""Error over distance for a method of second order, 2^p/(2^p - 1).

First order has 2, third 1.14: from order 1/2 upwards the estimate is within a factor of 2.6.
"""
LEAST_CHANGES = 5
"""Changes of an output from which on a stair is told from a signal that hardly moves."""


def estimate(series: Values, halved: Values) -> Estimate:
    """Error of `series` from the same values at half the communication steps.

    With an error C h^p the distance d of the two is (1 - 2^-p) C h^p, so the error is
    d 2^p/(2^p - 1); see `BEYOND`. It is relative to the largest value of either. Errors that both
    runs have in common are not in it: those of the instances' own solvers, and the physics that
    the parts leave out.
    """
    error = BEYOND * float(np.abs(series - halved).max(initial=0.0))
    largest = max(float(np.abs(each).max(initial=0.0)) for each in (series, halved))
    return Estimate(error, error / largest if largest else 0.0)


def halved(points: Sequence[float]) -> list[float]:
    """Communication points with one more in the middle of each step."""
    ends = np.asarray(points, dtype=float)
    both = np.empty(2 * len(ends) - 1)
    both[::2] = ends
    both[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return both.tolist()


def with_estimates(outcome: Outcome, finer: Outcome) -> Outcome:
    """An outcome with its errors estimated from the same run at half of every step.

    Real variables get an `Estimate`, metrics an error in their unit. `unseen` names what the
    distance of the two runs does not show.
    """
    times, rows = whole(outcome)
    _, mine, other = np.intersect1d(times, finer.times, return_indices=True)
    shared, closer = rows[mine], finer.rows[other]
    real = {k: name for k, name in enumerate(outcome.names) if outcome.plan.records[k][1].real}
    return replace(
        outcome,
        estimates={name: estimate(shared[:, k], closer[:, k]) for k, name in real.items()},
        metric_errors=_metric_errors(_of_rows(outcome, times, rows), recorded(finer)),
        unseen={**outcome.unseen, **dict(_unseen(outcome, shared, closer, finer.rows))},
    )


def _of_rows(outcome: Outcome, times: Values, rows: Values) -> Recorded:
    """The series of an outcome with all of its rows."""
    return recorded(replace(outcome, times=times, rows=rows, segments=None))


def _metric_errors(coarse: Recorded, finer: Recorded) -> dict[str, float]:
    """Errors of metrics, in SI; the finer run has twice the rows, so sampling counts too."""
    values = {metric.name: metric.value for metric in metrics(finer)}
    found = {
        metric.name: BEYOND * abs(metric.value - values[metric.name])
        for metric in metrics(coarse)
        if metric.name in values
    }
    return {name: error for name, error in found.items() if np.isfinite(error)}


def _unseen(
    outcome: Outcome, shared: Values, closer: Values, finer: Values
) -> Iterator[tuple[str, str]]:
    """What an estimate does not show, by variable or by component, with the reason."""
    places: dict[str, list[int]] = {}
    plan = outcome.plan
    wired = {f"{c.source}.{c.output.name}" for c in plan.connections}
    located = plan.scenario.time.tolerance is not None and plan.rolls_back
    for k, (component, variable) in enumerate(outcome.plan.records):
        if variable.real:
            places.setdefault(component, []).append(k)
            continue
        if variable.switches and outcome.names[k] in wired:
            turns = int(np.count_nonzero(finer[1:, k] != finer[:-1, k]))
            if turns and not located:
                text = f"switches {turns} times, each up to a step late, which adds up unseen"
                yield outcome.names[k], f"{text}; a tolerance locates them"
            continue
        differ = int(np.count_nonzero(shared[:, k] != closer[:, k]))
        if differ:
            text = f"differs at {differ} of {len(shared)} points at half the step"
            yield outcome.names[k], f"{text}: it switches at another time"
    every = outcome.plan.scenario.record.every
    for component, columns in places.items():
        if outcome.plan.interfaces[component].ours or every > 1:
            continue
        apart = _stair(finer[:, columns])
        if apart:
            text = f"its outputs change at every {apart}th of the half steps at most"
            yield component, f"{text}: the error of a step of its own is not in the estimate"


def _stair(rows: Values) -> int:
    """Least number of points between changes of any column, 0 for what moves at every point."""
    changes = np.flatnonzero((rows[1:] != rows[:-1]).any(axis=1))
    if len(changes) < LEAST_CHANGES:
        return 0
    apart = int(np.diff(changes).min())
    return apart if apart > 1 else 0
