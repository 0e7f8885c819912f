"""Least squares through the FMUs: values, their intervals, and whether the residuals are noise.

With y the recorded and f(p) the simulated outputs at N points, each output j divided by the size
s_j of its own residuals, the estimate minimises sum ((y_j - f_j(p)) / s_j)^2. For residuals that
are independent noise its covariance is

    cov(p) = s^2 (J^T J)^-1,    s^2 = sum r^2 / (N - n),    J = df/dp / s_j,

and the interval of a parameter is Student's quantile times the root of its diagonal element.
Where neighbouring residuals are correlated by r (lag one), N points count as N (1 - r) / (1 + r),
and intervals are wider by the root of the inverse.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, SimulationError
from ...results.error_estimate import BEYOND, halved
from ...simulation.guarded.kept import kept_between_runs
from ...simulation.interrupt import Interrupt, Interrupted
from ...simulation.run import replay
from .case import Case
from .parameter import Unknown

Values = NDArray[np.float64]
NUDGE = 1e-4
"""Change of a parameter, of its scale, for derivatives by central differences."""
LITTLE = 0.9
"""Explained share below which an output whose residuals are not noise was not met."""
COARSE = 0.1
"""Stepping error, relative to an output's deviation, above which the step decides the answer."""
HOPELESS = 1e3
"""Residual, in sizes of the recorded output, where the parts stop at some parameters."""


@dataclass(frozen=True)
class Settings:
    """How a fit is made: rows before `skip` [s] after the first do not count, `level` is the
    share of fits whose interval is to hold the value, `most` evaluations of the search."""

    skip: float = 0.0
    level: float = 0.95
    most: int = 60


@dataclass(frozen=True)
class Identified:
    """The result of a fit, SI.

    `values` are the parameters with half-widths `intervals` at `level` and their `correlation`;
    `recorded` and `simulated` have a column for each pair of the case, over `times`; `counted` are
    the rows that were fitted. `sizes` are root mean squares of the residuals, `lag_one` their
    correlations with their neighbours, `widened` by how much intervals are wider for that,
    `stepping` the largest difference to half the communication step. `singular` are the singular
    values of d residual / d ln parameter, largest first. `runs` counts simulations.
    """

    case: Case
    unknowns: Sequence[Unknown]
    level: float
    values: Values
    intervals: Values
    correlation: Values
    singular: Values
    times: Values
    counted: NDArray[np.bool_]
    recorded: Values
    simulated: Values
    sizes: Values
    lag_one: Values
    widened: float
    stepping: Values
    runs: int
    wall_time: float
    message: str

    @property
    def at_bounds(self) -> list[str]:
        """Parameters that the search has pushed to the end of their range."""
        found = []
        for unknown, value in zip(self.unknowns, self.values, strict=True):
            near = 1e-6 * unknown.scale
            if value <= unknown.low + near or value >= unknown.high - near:
                found.append(unknown.full)
        return found

    @property
    def shares(self) -> Values:
        """Share of each output's variance about its mean that is explained: 1 - |r|^2/|y - m|^2."""
        rows = self.recorded[self.counted]
        spread = ((rows - rows.mean(axis=0)) ** 2).mean(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(1.0 - self.sizes**2 / spread)

    @property
    def missed(self) -> NDArray[np.bool_]:
        """Outputs of which little is explained although noise is not the reason."""
        left = (self.recorded - self.simulated)[self.counted]
        with np.errstate(divide="ignore", invalid="ignore"):
            alike = np.abs((left[1:] * left[:-1]).sum(axis=0)) / (left**2).sum(axis=0)
            little = self.shares < LITTLE
        return np.asarray(self.varies & little & (alike > 3.0 / sqrt(len(left))))

    @property
    def coarse(self) -> NDArray[np.bool_]:
        """Outputs of which the communication step decides a notable share."""
        deviation = self.recorded[self.counted].std(axis=0)
        return np.asarray(self.varies & (self.stepping > COARSE * deviation))

    @property
    def varies(self) -> NDArray[np.bool_]:
        """Outputs whose recorded values change by more than rounding."""
        rows = self.recorded[self.counted]
        return np.asarray(rows.std(axis=0) > 1e-9 * np.abs(rows).max(axis=0))


class _Experiment:
    """The case as a function from parameters to outputs."""

    def __init__(
        self, case: Case, unknowns: Sequence[Unknown], interrupt: Interrupt | None
    ) -> None:
        self.case = case
        self.unknowns = unknowns
        self.runs = 0
        self._interrupt = interrupt

    def run(self, values: Sequence[float], points: Sequence[float] | None = None) -> Values:
        """Recorded and simulated outputs side by side; `SimulationError` where the parts stop."""
        starts = {name: dict(start) for name, start in self.case.plan.starts.items()}
        for unknown, value in zip(self.unknowns, values, strict=True):
            starts[unknown.component][unknown.name] = float(value)
        self.runs += 1
        plan = replace(self.case.plan, starts=starts)
        outcome = replay(plan, points or self.case.points, self._interrupt)
        if outcome.failure is not None:
            raise outcome.failure
        names = [name for pair in self.case.pairs for name in pair]
        return np.column_stack([outcome.series(name) for name in names])


@kept_between_runs()
def identify(
    case: Case,
    unknowns: Sequence[Unknown],
    settings: Settings | None = None,
    *,
    interrupt: Interrupt | None = None,
    tell: Callable[[str], None] | None = None,
) -> Identified:
    """Estimate parameters of a case's parts; see the module for what is minimised.

    Raises :class:`SimulationError` where the parts stop at their start values, and
    :class:`InputError` where the rows are too few to determine the parameters.
    """
    begun = perf_counter()
    wanted = settings or Settings()
    experiment = _Experiment(case, unknowns, interrupt)
    first = experiment.run([unknown.start for unknown in unknowns])
    recorded = first[:, ::2]
    times = np.asarray(case.points)
    counted = times >= times[0] + wanted.skip - 1e-12 * abs(times[-1])
    free = int(counted.sum()) * recorded.shape[1] - len(unknowns)
    if free < 1:
        raise InputError(
            f"{case.plan.recordings['recording'].interface.path}: {int(counted.sum())} rows do not"
            f" determine {len(unknowns)} parameters"
        )
    spread = np.sqrt((recorded[counted] ** 2).mean(axis=0))
    spread[spread == 0.0] = 1.0
    places, sizes, message = np.ones(len(unknowns)), spread, ""
    for _ in range(2 if recorded.shape[1] > 1 else 1):
        found = _search(experiment, recorded, counted, spread, sizes, places, wanted, tell)
        places, message = found.x, str(found.message)
        residuals = (found.fun * np.tile(sizes, int(counted.sum()))).reshape(-1, len(sizes))
        sizes = np.maximum(np.sqrt((residuals**2).mean(axis=0)), 1e-12 * spread)
    values = np.array([u.value(p) for u, p in zip(unknowns, places, strict=True)])
    rows = experiment.run(values.tolist())
    finer = experiment.run(values.tolist(), halved(case.points))[::2]
    simulated = rows[:, 1::2]
    jacobian = _jacobian(experiment, values, counted) / np.tile(sizes, int(counted.sum()))[:, None]
    residuals = (recorded - simulated)[counted]
    chi = float(((residuals / sizes) ** 2).sum() / free)
    lag_one = np.array([_lag_one(column) for column in residuals.T])
    widened = _widened(lag_one, int(counted.sum()))
    covariance = chi * np.linalg.pinv(jacobian.T @ jacobian)
    deviations = np.sqrt(np.diag(covariance))
    quantile = _quantile(wanted.level, free)
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = covariance / np.outer(deviations, deviations)
    scales = np.array([unknown.scale for unknown in unknowns])
    return Identified(
        case=case,
        unknowns=unknowns,
        level=wanted.level,
        values=values,
        intervals=quantile * widened * deviations,
        correlation=correlation,
        singular=np.linalg.svd(jacobian * scales, compute_uv=False),
        times=times,
        counted=counted,
        recorded=recorded,
        simulated=simulated,
        sizes=np.sqrt((residuals**2).mean(axis=0)),
        lag_one=lag_one,
        widened=widened,
        stepping=BEYOND * np.abs(finer[:, 1::2] - simulated)[counted].max(axis=0),
        runs=experiment.runs,
        wall_time=perf_counter() - begun,
        message=message,
    )


def _search(
    experiment: _Experiment, recorded: Values, counted: NDArray[np.bool_], spread: Values,
    sizes: Values, places: Values, settings: Settings, tell: Callable[[str], None] | None,
) -> Any:  # fmt: skip
    """One minimisation from `places`, each output divided by its size."""
    from scipy.optimize import least_squares

    unknowns = experiment.unknowns
    low = np.array([u.place(u.low) for u in unknowns])
    high = np.array([u.place(u.high) for u in unknowns])

    def residuals(at: Values) -> Values:
        values = [u.value(p) for u, p in zip(unknowns, at, strict=True)]
        try:
            simulated = experiment.run(values)[:, 1::2]
        except Interrupted:
            raise
        except SimulationError:
            return np.full(int(counted.sum()) * len(sizes), HOPELESS) * np.tile(
                spread / sizes, int(counted.sum())
            )
        left = ((recorded - simulated) / sizes)[counted]
        if tell is not None:
            named = ", ".join(f"{u.full} = {v:.6g}" for u, v in zip(unknowns, values, strict=True))
            tell(f"{experiment.runs} runs, rms {np.sqrt((left**2).mean()):.4g}: {named}")
        return np.asarray(left.ravel())

    begin = np.clip(places, low, high)
    return least_squares(
        residuals, begin, jac="3-point", bounds=(low, high), diff_step=NUDGE, x_scale=1.0,
        xtol=1e-10, ftol=1e-10, gtol=1e-12, max_nfev=settings.most,
    )  # fmt: skip


def _jacobian(experiment: _Experiment, values: Values, counted: NDArray[np.bool_]) -> Values:
    """Derivatives of the counted outputs, flattened, by each parameter, within its bounds."""
    columns = []
    for k, unknown in enumerate(experiment.unknowns):
        step = NUDGE * unknown.scale
        ends = []
        for sign in (1.0, -1.0):
            moved = values.copy()
            moved[k] = min(max(values[k] + sign * step, unknown.low), unknown.high)
            ends.append((moved[k], experiment.run(moved.tolist())[counted, 1::2].ravel()))
        (upper, above), (lower, below) = ends
        columns.append((above - below) / (upper - lower))
    return np.column_stack(columns)


def _lag_one(residuals: Values) -> float:
    """Correlation of residuals with their neighbours; 0 for residuals that do not vary."""
    left = residuals - residuals.mean()
    power = float(left @ left)
    return float(left[1:] @ left[:-1]) / power if power > 0.0 else 0.0


def _widened(lag_one: Values, count: int) -> float:
    """Factor by which correlated residuals widen the intervals; 1 where chance explains them."""
    worst = float(lag_one.max(initial=0.0))
    if worst < 3.0 / sqrt(count):
        return 1.0
    return sqrt((1.0 + worst) / max(1.0 - worst, 1e-6))


def _quantile(level: float, free: int) -> float:
    from scipy.stats import t

    return float(t.ppf(0.5 + 0.5 * level, free))
