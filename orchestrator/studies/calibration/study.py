"""A fit carried out, or only looked at: values, residuals, sensitivities, how sure it all is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ...scenario.library import LIBRARY
from ...simulation.guarded.kept import kept_between_runs
from ...simulation.interrupt import Interrupt
from .fits import Fit
from .predictions import Model

NUDGE = 0.02
"""Relative change of a parameter for the sensitivities."""

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Calibration:
    """What came of a fit.

    `shipped` and `fitted` are the parameters before and after (SI), `paper`, `before` and
    `after` the data; `sensitivity` is d ln datum / d ln parameter at the fitted values
    (data, parameters), held-out data included. `uncertainty` is the relative standard deviation
    of each datum of the paper, NaN where none is stated. `runs` counts runs of scenarios.
    """

    fit: Fit
    shipped: Values
    fitted: Values
    paper: Values
    before: Values
    after: Values
    sensitivity: Values
    uncertainty: Values
    runs: int
    wall_time: float
    message: str

    @property
    def errors(self) -> Values:
        """Relative error of each datum at the fitted values."""
        return self.after / self.paper - 1.0

    @property
    def singular(self) -> Values:
        """Singular values of the sensitivities of the fitted data, largest first.

        A small one is a combination of parameters that the data hardly see.
        """
        used = [not datum.held_out for datum in self.fit.data]
        return np.asarray(np.linalg.svd(self.sensitivity[used], compute_uv=False))

    @property
    def covariance(self) -> Values:
        """Covariance of the parameters' relative changes for one per cent of noise on every datum.

        The fit weighs a datum by how well it is known: dp = (W S)^+ W dy, with W = 1/within.
        """
        return np.asarray(1e-4 * self.gain @ self.gain.T)

    @property
    def gain(self) -> Values:
        """d ln parameter / d ln datum of the fitted data (parameters, fitted data)."""
        used = [not datum.held_out for datum in self.fit.data]
        weights = np.array([1.0 / datum.within for datum in self.fit.data])[used]
        return np.asarray(np.linalg.pinv(weights[:, None] * self.sensitivity[used]) * weights)

    @property
    def scatter(self) -> float:
        """How far the fitted data are missed, in units of `within`; 0 where none is left over.

        s^2 = sum (e_k/w_k)^2/(n - p), with n fitted data and p parameters.
        """
        used = [not datum.held_out for datum in self.fit.data]
        within = np.array([datum.within for datum in self.fit.data])
        spare = sum(used) - len(self.fit.parameters)
        if spare == 0:
            return 0.0
        return float(np.sqrt(np.sum((self.errors / within)[used] ** 2) / spare))

    @property
    def band(self) -> Values:
        """Relative standard deviation of each datum by those of the fitted ones; NaN without.

        d ln y = S G d ln(fitted data), to first order; the fitted data are independent. Where the
        model misses them by more than they are uncertain, its misses count: each deviates by
        max(u_k, s w_k) with `scatter` s.
        """
        used = [not datum.held_out for datum in self.fit.data]
        within = np.array([datum.within for datum in self.fit.data])
        deviation = np.maximum(self.uncertainty, self.scatter * within)[used]
        spread = self.sensitivity @ self.gain * deviation
        return np.asarray(np.sqrt(np.sum(spread**2, axis=1)))

    @property
    def spread(self) -> Values:
        """Relative change of each parameter for one per cent of noise on every fitted datum."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def correlation(self) -> Values:
        """Correlation of the parameters' errors under equal noise on the fitted data."""
        size = self.spread
        return np.asarray(self.covariance / np.outer(size, size))


@kept_between_runs()
def calibrate(
    fit: Fit,
    library: Path = LIBRARY,
    *,
    refit: bool = True,
    interrupt: Interrupt | None = None,
    tell: Callable[[str], None] | None = None,
) -> Calibration:
    """Fit by least squares on relative errors, each by how well its datum is known.

    Parameters move as logarithms within their bounds. Without `refit` they stay, and errors
    and sensitivities are of the shipped values. Raises `SimulationError` where a scenario stops
    or has no peak at the shipped values.
    """
    begun = perf_counter()
    model = Model(fit, library, interrupt)
    used = np.array([not datum.held_out for datum in fit.data])
    within = np.array([datum.within for datum in fit.data])
    shipped, paper = np.array(model.start), np.array(model.paper)
    before = np.array(model.values(shipped.tolist()))

    def residuals(logs: Values) -> Values:
        values = np.array(model.values((shipped * np.exp(logs)).tolist()))
        if tell is not None:
            tell(f"{model.runs} runs, largest error {np.abs(values / paper - 1.0)[used].max():.2e}")
        return np.asarray(((values / paper - 1.0) / within)[used])

    def slopes(logs: Values) -> Values:
        here = residuals(logs)
        step = NUDGE * np.eye(len(logs))
        return np.array([(residuals(logs + each) - here) / NUDGE for each in step]).T

    logs, message = np.zeros(len(shipped)), "not fitted again"
    if refit:
        from scipy.optimize import least_squares

        bounds = (np.log(np.array(model.low) / shipped), np.log(np.array(model.high) / shipped))
        found = least_squares(
            residuals, logs, jac=slopes, bounds=bounds, x_scale=0.1, xtol=1e-4, ftol=1e-8,
            max_nfev=12,
        )  # fmt: skip
        logs, message = found.x, str(found.message)
    fitted = shipped * np.exp(logs)
    after = np.array(model.values(fitted.tolist()))
    columns = []
    for k in range(len(fitted)):
        ends = []
        for sign in (1.0, -1.0):
            moved = fitted.copy()
            moved[k] *= np.exp(sign * NUDGE)
            ends.append(np.array(model.values(moved.tolist())))
        columns.append(np.log(ends[0] / ends[1]) / (2.0 * NUDGE))
    return Calibration(
        fit=fit,
        shipped=shipped,
        fitted=fitted,
        paper=paper,
        before=before,
        after=after,
        sensitivity=np.array(columns).T,
        uncertainty=np.array(model.uncertainty),
        runs=model.runs,
        wall_time=perf_counter() - begun,
        message=message,
    )
