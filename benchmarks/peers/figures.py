"""Figures of a run and of a curve: error, order, stroke, time to an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, exp, isfinite, log, nan

import numpy as np
from scipy.interpolate import CubicSpline

from .case import Case
from .measured_run import MeasuredRun
from .reference import Reference

TARGET = 1e-3
FINE = 2000
"""Points per cycle at which a spline through the compared points is searched for peaks."""
RESOLVED = 0.5
"""Error above which a run is too coarse to give an order."""


@dataclass(frozen=True)
class Cost:
    """Time [s] to an error; `sure` if a run reached it. NaN where the error does not fall."""

    seconds: float
    sure: bool

    def __str__(self) -> str:
        if not isfinite(self.seconds):
            return "not reached"
        return f"{'' if self.sure else '~ '}{self.seconds:.3g}"


def judge(
    measured: MeasuredRun, case: Case, reference: Reference, before: MeasuredRun | None
) -> None:
    """Fill in the figures of a run that is done, or mark it as diverged."""
    times, rows = thinned(measured.times, np.asarray(measured.rows), case)
    if not len(rows) or not np.isfinite(rows).all() or np.abs(rows).max() > 1e6:
        measured.status, measured.reason = "diverged", "values left all bounds"
        return
    exact = reference.at(times)
    measured.error = float(np.max(np.abs(rows - exact).max(axis=0) / np.abs(exact).max(axis=0)))
    if before is not None and isfinite(before.error) and max(measured.error, before.error) > 0.0:
        measured.order = slope(before, measured)
    cycle = case.step * case.per_cycle
    for k, name in enumerate(w.name for w in case.watched):
        span, beat = oscillation(times, rows[:, k], cycle)
        if name == "flap_angle":
            measured.stroke = degrees(span)
        else:
            measured.travel = span
        measured.frequency = beat


def thinned(times: Sequence[float], rows: np.ndarray, case: Case) -> tuple[list[float], np.ndarray]:
    """Points nearest to the points of comparison, where a tool chose more points of its own."""
    wanted = case.count // case.every
    if len(times) <= wanted:
        return list(times), rows
    own = np.asarray(times)
    points = (np.arange(wanted) + 1) * case.every * case.step
    right = np.clip(np.searchsorted(own, points), 1, len(own) - 1)
    left = right - (points - own[right - 1] < own[right] - points)
    kept = np.unique(left)
    return [float(t) for t in own[kept]], rows[kept]


def oscillation(times: Sequence[float], series: np.ndarray, cycle: float) -> tuple[float, float]:
    """Peak-to-peak of the last cycle, and the frequency [Hz] by its last two upward crossings."""
    curve = CubicSpline(times, series)
    end = times[-1]
    last = curve(np.linspace(end - cycle, end, FINE + 1))
    span = float(last.max() - last.min())
    if end - times[0] < 2.2 * cycle:
        return span, nan
    grid = np.linspace(end - 2.2 * cycle, end, int(2.2 * FINE))
    values = curve(grid) - 0.5 * (last.max() + last.min())
    up = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    if len(up) < 2:
        return span, nan
    exact = grid[up] - values[up] * (grid[up + 1] - grid[up]) / (values[up + 1] - values[up])
    return span, float((len(exact) - 1) / (exact[-1] - exact[0]))


def slope(coarse: MeasuredRun, fine: MeasuredRun) -> float:
    """Order of the error in the work, counted in calls: in the step, where steps are equal."""
    if coarse.calls == fine.calls or min(coarse.error, fine.error) <= 0.0:
        return nan
    return log(coarse.error / fine.error) / log(fine.calls / coarse.calls)


def cost(curve: Sequence[MeasuredRun], target: float = TARGET) -> Cost:
    """Time to an error along a curve, coarse to fine.

    Between two runs on either side of it log error is linear in log time; beyond the last one the
    order between the last two goes on, each call at the cost of the last run's.
    """
    done = [r for r in curve if r.status == "done" and isfinite(r.error) and r.wall > 0.0]
    for k, measured in enumerate(done):
        if measured.error > target:
            continue
        if k == 0 or done[k - 1].error <= measured.error or done[k - 1].wall >= measured.wall:
            return Cost(measured.wall, True)
        above = done[k - 1]
        share = log(above.error / target) / log(above.error / measured.error)
        return Cost(exp(log(above.wall) + share * log(measured.wall / above.wall)), True)
    resolved = [r for r in done if r.error < RESOLVED]
    if len(resolved) < 2:
        return Cost(nan, False)
    order = slope(resolved[-2], resolved[-1])
    if not order > 0.2:
        return Cost(nan, False)
    last = resolved[-1]
    return Cost(last.wall * (last.error / target) ** (1.0 / order), False)
