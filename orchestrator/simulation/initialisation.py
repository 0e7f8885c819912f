"""Consistent values of a loop without a step between: by fixed-point passes, else by Newton."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .coupled_instance import CoupledInstance, Indices, Values

UNCHANGED = 1e-12
SOLVED = 1e-10
TRUSTED = 1e-8
"""Largest correction that Newton's method would still make to a solution, relative."""
MOST_PASSES = 50
MOST_NEWTON = 12
TINY = 1e-30


class InconsistentValues(Exception):
    """Neither passes nor Newton's method converged.

    `place` is that of the value that changed most in the last pass, `change` by how much.
    """

    def __init__(self, place: int, change: float) -> None:
        super().__init__(place, change)
        self.place = place
        self.change = change


def make_consistent(instances: Sequence[CoupledInstance], values: Values, wired: Indices) -> float:
    """Bring all outputs and inputs of `instances` into agreement; return the relative residual.

    Fixed-point passes first, which end at once where there is no loop; where these do not
    contract, Newton's method on the wired values with a Jacobian by differences. Raises
    `InconsistentValues` where that fails too.
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
            if np.all(change <= UNCHANGED * scale):
                return float((change / scale).max(initial=0.0))
        worst = int(np.argmax(np.where(np.isfinite(change), change, np.inf)))
        values[:] = start
        residual = _newton(instances, values, _own(instances, wired))
    if residual is None:
        values[:] = start
        raise InconsistentValues(worst, float(change[worst]))
    return residual


def _own(instances: Sequence[CoupledInstance], wired: Indices) -> Indices:
    """Those wired places that are outputs of these instances."""
    ours = [(wired >= m.stretch.start) & (wired < m.stretch.stop) for m in instances]
    return np.asarray(wired[np.any(ours, axis=0)])


def _passed(
    instances: Sequence[CoupledInstance], values: Values, wired: Indices, guess: Values
) -> Values:
    """Values of the wired outputs once the inputs are made from a guess of them."""
    values[wired] = guess
    for coupled in instances:
        coupled.gather()
    for coupled in instances:
        coupled.instance.receive()
    return values[wired].copy()


def _newton(instances: Sequence[CoupledInstance], values: Values, wired: Indices) -> float | None:
    """Relative residual once z = G(z) is solved; None where it cannot be.

    A small residual alone proves nothing: where the loop has no solution, as in z = z + 1, it is
    small beside any large z. The next correction of Newton's method has to be small as well.
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
