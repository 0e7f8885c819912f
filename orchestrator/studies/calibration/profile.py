"""A fit repeated along something that its data do not fix: what moves with it, and what tells.

Each point starts from the last two, continued along a line, since the fitted parameters follow the
share almost linearly. From there Newton's method with the sensitivities of the shipped values, to
which Broyden's rank-one updates add what each step teaches: a tenth of the runs of a fresh fit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import InputError, SimulationError
from ...scenario.library import LIBRARY
from ...simulation.interrupt import Interrupt
from .fits import Fit
from .predictions import Model
from .study import NUDGE, Values

MET = 2e-4
"""Largest relative error of a fitted datum at which a point counts as found."""

MOST_STEPS = 12

LARGEST = 0.15
"""Largest change of a parameter in one step, relative."""


@dataclass(frozen=True)
class Point:
    """One share: the parameters fitted there, and all data, both in SI."""

    share: float
    parameters: Values
    data: Values


def profile(
    fit: Fit,
    library: Path = LIBRARY,
    interrupt: Interrupt | None = None,
    tell: Callable[[str], None] | None = None,
) -> list[Point]:
    """All points of a fit's profile, in the order of its shares.

    Raises `InputError` where the fit has none, `SimulationError` where a point is not found.
    """
    if fit.profile is None:
        raise InputError(f"{fit.name}: has no profile")
    return list(_points(_Search(fit, library, interrupt, tell), fit.profile.shares))


class _Search:
    """Newton's method on a fit's residuals, with a Jacobian that is kept from point to point."""

    def __init__(
        self, fit: Fit, library: Path, interrupt: Interrupt | None,
        tell: Callable[[str], None] | None,
    ) -> None:  # fmt: skip
        self.model = Model(fit, library, interrupt)
        self.start = np.array(self.model.start)
        self._fit = fit
        self._paper = np.array(self.model.paper)
        self._used = np.array([not datum.held_out for datum in fit.data])
        self._within = np.array([datum.within for datum in fit.data])[self._used]
        self._slopes: Values | None = None
        self._tell = tell

    def found(self, parameters: Values, share: float) -> Point:
        """The point at a share, looked for from these parameters on."""
        logs = np.log(parameters / self.start)
        left, data = self._residuals(logs, share)
        if self._slopes is None:
            self._slopes = self._differences(logs, left, share)
        slopes = self._slopes
        for _ in range(MOST_STEPS):
            surplus = len(left) > len(logs)
            if np.abs(left).max() < MET or (surplus and self._is_flat(slopes, left)):
                return Point(share, self.start * np.exp(logs), data)
            step = -np.linalg.lstsq(slopes, left, rcond=None)[0]
            step *= min(1.0, LARGEST / float(np.abs(step).max()))
            logs = logs + step
            before, (left, data) = left, self._residuals(logs, share)
            learnt = left - before - slopes @ step
            slopes = slopes + np.outer(learnt, step) / float(step @ step)
            self._slopes = slopes
        raise SimulationError(
            f"{self._fit.name}: no fit at a share of {share:g} after {MOST_STEPS} steps:"
            f" still off by {np.abs(left).max():.1e}"
        )

    def _is_flat(self, slopes: Values, left: Values) -> bool:
        """Whether no step promises to better more data than parameters can meet."""
        return bool(np.abs(np.linalg.lstsq(slopes, left, rcond=None)[0]).max() < MET)

    def _residuals(self, logs: Values, share: float) -> tuple[Values, Values]:
        data = np.array(self.model.values((self.start * np.exp(logs)).tolist(), share))
        left = (data[self._used] / self._paper[self._used] - 1.0) / self._within
        if self._tell is not None:
            self._tell(f"share {share:g}: {self.model.runs} runs, off by {np.abs(left).max():.1e}")
        return np.asarray(left), data

    def _differences(self, logs: Values, left: Values, share: float) -> Values:
        columns = []
        for each in NUDGE * np.eye(len(logs)):
            moved, _ = self._residuals(logs + each, share)
            columns.append((moved - left) / NUDGE)
        return np.array(columns).T


def _points(search: _Search, shares: list[float]) -> Iterator[Point]:
    done: list[Point] = []
    for share in shares:
        guess = search.start
        if len(done) == 1:
            guess = done[0].parameters
        if len(done) > 1:
            one, two = done[-2:]
            slope = (two.parameters - one.parameters) / (two.share - one.share)
            guess = np.maximum(two.parameters + slope * (share - two.share), 0.1 * two.parameters)
        done.append(search.found(guess, share))
        yield done[-1]
