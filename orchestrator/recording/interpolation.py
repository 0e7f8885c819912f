"""Samples as functions of time: piecewise polynomials, their slopes and their means."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .table import Values

REFINED = 8
"""Pieces between two samples of a band-limited record."""
BESIDE = 1e-9
"""Part of the shortest step within which a time counts as that of a sample."""
KAISER = 12.0
GAUSS = np.polynomial.legendre.leggauss(4)
PLACES, SHARES = 0.5 * (GAUSS[0] + 1.0), 0.5 * GAUSS[1]
"""Nodes and weights on 0 to 1 that integrate the square of a cubic exactly."""


LARGEST = 1e100
"""Largest value, in the unit of its column, and time [s]; a run stops at such a value too."""
SHORTEST = 1e-60
"""Shortest step [s]: the coefficients of a cubic through `LARGEST` values then have an exponent."""


class Unfit(ValueError):
    """Samples through which no interpolant goes: the sample `row`, and the `column` of its value.

    `column` is None where the time of the sample is what does not fit.
    """

    def __init__(self, reason: str, row: int, column: int | None = None) -> None:
        super().__init__(reason)
        self.row = row
        self.column = column


@dataclass(frozen=True)
class Track:
    """Columns over time as polynomials y = c0 + c1 s + ..., s from the last knot.

    `pieces` has the shape (pieces, degree + 1, columns). With a `period` [s] the record goes on
    in both directions; else `before` it and `after` it the values are held, or zero. `first`
    and `second` are the integrals of y and y^2 from the start to each knot. A time closer to a
    knot than `grain` [s] counts as that of the knot.
    """

    knots: Values
    pieces: NDArray[np.float64]
    last: Values
    period: float
    before: str
    after: str
    first: Values
    second: Values
    grain: float

    @property
    def begin(self) -> float:
        """Time of the first sample [s]."""
        return float(self.knots[0])

    @property
    def end(self) -> float:
        """Time of the last sample, or that of its repetition [s]."""
        return self.begin + self.period if self.period else float(self.knots[-1])

    def at(self, time: float, *, stepped: bool = False) -> tuple[Values, Values]:
        """Values and slopes; `stepped` takes the slope of the piece that ends at this time."""
        values = self._inside(time)
        if stepped or (not self.period and time > self.end - self.grain):
            return values, self._slope(time - 2.0 * self.grain, time)
        return values, self._slope(time, time)

    def means(self, time: float, size: float) -> tuple[Values, Values]:
        """Means of y and of y^2 over the step of this size [s] that ends at a time, exactly."""
        first, second = self._integrals(time)
        earlier, earlier_second = self._integrals(time - size)
        return (first - earlier) / size, (second - earlier_second) / size

    def _wrapped(self, time: float) -> tuple[float, int]:
        """Time within the record, and how many repetitions lie before it."""
        if not self.period:
            return time, 0
        turns = int(np.floor((time - self.begin + self.grain) / self.period))
        return time - turns * self.period, turns

    def _piece(self, time: float) -> int:
        k = int(np.searchsorted(self.knots, time + self.grain, side="right")) - 1
        return min(max(k, 0), len(self.pieces) - 1)

    def _inside(self, time: float) -> Values:
        time, _ = self._wrapped(time)
        if time < self.begin - self.grain:
            return self._outside(self.before, self.pieces[0, 0])
        if not self.period and time > self.end - self.grain:
            return (
                self._outside(self.after, self.last) if time > self.end + self.grain else self.last
            )
        k = self._piece(time)
        s = time - self.knots[k]
        value = self.pieces[k, -1]
        for c in self.pieces[k, -2::-1]:
            value = c + s * value
        return np.array(value)

    def _slope(self, which: float, time: float) -> Values:
        """Slope at a time of the piece in which another time lies."""
        which, turns = self._wrapped(which)
        time -= turns * self.period
        if which < self.begin - self.grain or (not self.period and which > self.end):
            return np.zeros_like(self.last)
        k = self._piece(which)
        s = time - self.knots[k]
        slope = np.zeros_like(self.last)
        for power in range(self.pieces.shape[1] - 1, 0, -1):
            slope = power * self.pieces[k, power] + s * slope
        return slope

    @staticmethod
    def _outside(how: str, value: Values) -> Values:
        return np.zeros_like(value) if how == "zero" else value

    def _integrals(self, time: float) -> tuple[Values, Values]:
        """Integrals of y and y^2 from the start of the record to a time."""
        time, turns = self._wrapped(time)
        first, second = turns * self.first[-1], turns * self.second[-1]
        if time < self.begin:
            value = self._outside(self.before, self.pieces[0, 0])
            return first + (time - self.begin) * value, second + (time - self.begin) * value**2
        if time >= self.end:
            value = self._outside(self.after, self.last)
            late = time - self.end
            return first + self.first[-1] + late * value, second + self.second[-1] + late * value**2
        k = self._piece(time)
        ours, squares = integrals(self.pieces[k : k + 1], np.array([time - self.knots[k]]))
        return first + self.first[k] + ours[0], second + self.second[k] + squares[0]


def integrals(pieces: NDArray[np.float64], widths: Values) -> tuple[Values, Values]:
    """Integrals of y and y^2 over the first stretch of each piece."""
    s = PLACES[:, None, None] * widths[:, None]
    y = pieces[:, -1] + np.zeros_like(s)
    for power in range(pieces.shape[1] - 2, -1, -1):
        y = pieces[:, power] + s * y
    weighted = SHARES[:, None, None] * widths[:, None]
    return (weighted * y).sum(axis=0), (weighted * y * y).sum(axis=0)


def fitted(
    times: Values, values: Values, kind: str, *, period: float = 0.0,
    before: str = "hold", after: str = "hold",
) -> Track:  # fmt: skip
    """Track through samples (rows over `times`), whose times rise.

    With a `period` longer than the record its first row closes it. Raises `Unfit` where values or
    steps are beyond what the polynomials can hold, or uneven steps are to be band-limited.
    """
    _check_range(times, values, REFINED if kind == "band-limited" else 1)
    if period > (times[-1] - times[0]) * (1.0 + BESIDE):
        times = np.append(times, times[0] + period)
        values = np.vstack([values, values[:1]])
    if kind == "band-limited":
        knots, pieces = _band_limited(times, values, bool(period))
    elif kind == "cubic" and len(times) > 2:
        knots, pieces = times, _monotone(times, values, bool(period))
    elif kind == "held":
        knots, pieces = times, values[:-1, None, :].copy()
    else:
        slopes = np.diff(values, axis=0) / np.diff(times)[:, None]
        knots, pieces = times, np.stack([values[:-1], slopes], axis=1)
    sums = [
        np.vstack([np.zeros((1, values.shape[1])), np.cumsum(part, axis=0)])
        for part in integrals(pieces, np.diff(knots))
    ]
    grain = BESIDE * float(np.diff(knots).min())
    last = values[-1].copy()
    return Track(knots, pieces, last, period, before, after, sums[0], sums[1], grain)


def _check_range(times: Values, values: Values, refined: int) -> None:
    """Raise `Unfit` for the first sample beyond the range in which an interpolant is calculated."""
    if not (fits := np.abs(values) <= LARGEST).all():
        row, column = np.argwhere(~fits)[0]
        raise Unfit(f"{values[row, column]:.6g} is beyond +-{LARGEST:g}", int(row), int(column))
    if not (fits := np.abs(times) <= LARGEST).all():
        row = int(np.argmin(fits))
        raise Unfit(f"the time, {times[row]:.6g} s, is beyond +-{LARGEST:g} s", row)
    least = max(SHORTEST, 2.0 * refined * float(np.spacing(np.abs(times).max())))
    steps = np.diff(times)
    if not (fits := steps >= least).all():
        row = int(np.argmin(fits)) + 1
        raise Unfit(
            f"t = {times[row]:.17g} s is {steps[row - 1]:.3g} s after the row before; the numbers"
            f" of a computer tell times {least:.3g} s apart here: let them begin near 0",
            row,
        )


def _monotone(times: Values, values: Values, periodic: bool) -> NDArray[np.float64]:
    """Monotone cubics (Fritsch and Butland's slopes, as in scipy); no overshoot."""
    from scipy.interpolate import PchipInterpolator

    if not periodic:
        found = PchipInterpolator(times, values, axis=0).c
        return np.ascontiguousarray(found[::-1].transpose(1, 0, 2))
    span = times[-1] - times[0]
    wide = np.concatenate([times[-2:-1] - span, times, times[1:2] + span])
    found = PchipInterpolator(wide, np.vstack([values[-2:-1], values, values[1:2]]), axis=0).c
    return np.ascontiguousarray(found[::-1, 1:-1].transpose(1, 0, 2))


def _band_limited(
    times: Values, values: Values, periodic: bool
) -> tuple[Values, NDArray[np.float64]]:
    """Spline through the samples and, between them, a low-pass at their Nyquist frequency.

    A periodic record is resampled by its Fourier series; any other by a windowed sinc, continued
    beyond its ends as its odd reflection.
    """
    from scipy.interpolate import CubicSpline
    from scipy.signal import resample, resample_poly

    steps = np.diff(times)
    step = (times[-1] - times[0]) / len(steps)
    if np.abs(steps - step).max() > 1e-3 * step:
        k = int(np.argmax(np.abs(steps - step) > 1e-3 * step))
        raise Unfit(
            f"samples are {steps[k]:.6g} s apart at t = {times[k]:.6g} s and {step:.6g} s on"
            ' average: band-limited needs equal steps; choose "cubic"',
            k,
        )
    count = REFINED * len(steps)
    knots = np.linspace(times[0], times[-1], count + 1)
    if periodic:
        fine = resample(values[:-1], count, axis=0)
        fine = np.vstack([fine, fine[:1]])
    else:
        window = ("kaiser", KAISER)
        fine = resample_poly(values, REFINED, 1, axis=0, window=window, padtype="antireflect")
        fine = fine[: count + 1]
    fine[::REFINED] = values
    if periodic:
        fine[-1] = fine[0]
    found = CubicSpline(knots, fine, axis=0, bc_type="periodic" if periodic else "not-a-knot").c
    return knots, np.ascontiguousarray(found[::-1].transpose(1, 0, 2))
