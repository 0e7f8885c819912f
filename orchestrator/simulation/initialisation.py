"""Values that depend on each other without a step between: passed round, else solved for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .coupled_instance import CoupledInstance, Indices, Values

SETTLED = 1e-12
SOLVED = 1e-10
TRUSTED = 1e-8
"""What Newton's method would still correct of a solution, at most, relative."""
MOST_PASSES = 50
MOST_NEWTON = 12
TINY = 1e-30


class Unsettled(Exception):
    """Neither way came to an end: the place of the worst value, and by how much it moves."""

    def __init__(self, place: int, change: float) -> None:
        super().__init__(place, change)
        self.place = place
        self.change = change


def settle(instances: Sequence[CoupledInstance], values: Values, wired: Indices) -> float:
    """Bring all outputs and inputs of `members` into agreement; the residual left, relative.

    Fixed-point passes first, which end at once where there is no loop; where these do not
    contract, Newton's method on the wired values with a Jacobian by differences. Raises
    `Unsettled` where that fails too.
    """
    change = np.zeros(len(values))
    start = values.copy()
    with np.errstate(all="ignore"):
        for _ in range(MOST_PASSES):
            before = values.copy()
            for coupled in instances:
                coupled.follow()
            change = np.abs(values - before)
            scale = np.maximum(TINY, np.abs(values))
            if not np.all(np.isfinite(values)):
                break
            if np.all(change <= SETTLED * scale):
                return float((change / scale).max(initial=0.0))
        worst = int(np.argmax(np.where(np.isfinite(change), change, np.inf)))
        values[:] = start
        residual = _newton(instances, values, _own(instances, wired))
    if residual is None:
        values[:] = start
        raise Unsettled(worst, float(change[worst]))
    return residual


def _own(instances: Sequence[CoupledInstance], wired: Indices) -> Indices:
    """Those wired places that are outputs of these members."""
    ours = [(wired >= m.stretch.start) & (wired < m.stretch.stop) for m in instances]
    return np.asarray(wired[np.any(ours, axis=0)])


def _passed(
    instances: Sequence[CoupledInstance], values: Values, wired: Indices, guess: Values
) -> Values:
    """What the wired outputs become when the inputs are made from a guess of them."""
    values[wired] = guess
    for coupled in instances:
        coupled.gather()
    for coupled in instances:
        coupled.instance.receive()
    return values[wired].copy()


def _newton(instances: Sequence[CoupledInstance], values: Values, wired: Indices) -> float | None:
    """Relative residual once z = G(z) is solved for; None where it is not.

    A small residual alone proves nothing: where nothing solves the loop, as in z = z + 1, it is
    small beside any large z. What Newton would still correct has to be small as well.
    """
    guess = values[wired].copy()
    slope: Values | None = None
    for _ in range(MOST_NEWTON):
        there = _passed(instances, values, wired, guess)
        residual = there - guess
        if not np.all(np.isfinite(residual)):
            return None
        scale = np.maximum(TINY, np.maximum(np.abs(guess), np.abs(there)))
        left = float((np.abs(residual) / scale).max(initial=0.0))
        try:
            if slope is not None and left <= SOLVED:
                moved = np.linalg.solve(slope, residual)
                if np.all(np.abs(moved) <= TRUSTED * scale):
                    return left if np.all(np.isfinite(values)) else None
            slope = _slope(instances, values, wired, guess, there)
            guess = guess + np.linalg.solve(slope, residual)
        except np.linalg.LinAlgError:
            return None
    return None


def _slope(
    instances: Sequence[CoupledInstance],
    values: Values,
    wired: Indices,
    guess: Values,
    there: Values,
) -> Values:
    """1 - dG/dz by differences, column by column."""
    slope = np.eye(len(wired))
    for k in range(len(wired)):
        nudge = 1e-6 * max(abs(float(guess[k])), 1e-3)
        moved = guess.copy()
        moved[k] += nudge
        slope[:, k] -= (_passed(instances, values, wired, moved) - there) / nudge
    return slope
