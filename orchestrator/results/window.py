"""The last whole cycles of a result, and the numbers that can be taken from a series in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..units import UnitError, in_base
from .recorded import Recorded

Values = NDArray[np.float64]


class Window:
    """Recorded series in SI over the last `cycles` cycles of the drive, or over the whole run."""

    LEAST_ROWS: ClassVar[int] = 3

    class UndefinedError(Exception):
        """A frequency or a phase that does not exist, with the reason and the way out."""

    def __init__(self, data: Recorded, cycles: int) -> None:
        time = data.times
        self.drive = data.frequency
        begin = time[0] if len(time) else 0.0
        if self.drive > 0.0 and len(time):
            begin = max(begin, time[-1] - cycles / self.drive - 1e-9)
        self._first = int(np.searchsorted(time, begin))
        self.time = time[self._first :]
        self._series = data.series
        self.units = dict(data.units)

    @property
    def rows(self) -> int:
        """Number of rows in the window."""
        return len(self.time)

    def series(self, name: str) -> Values:
        """A recorded variable in the SI unit of its dimension."""
        values = np.asarray(self._series[name], dtype=float)[self._first :]
        try:
            scale = in_base(self.units[name])[1] if self.units[name] else 1.0
        except UnitError:
            scale = 1.0
        return values if scale == 1.0 else scale * values

    def reduced(self, function: str, series: Sequence[Values | float]) -> float:
        """A function of `orchestrator.scenario.metric_expression.FUNCTIONS`, applied to series."""
        one = np.broadcast_to(np.asarray(series[0], dtype=float), self.time.shape)
        span = self.time[-1] - self.time[0]
        match function:
            case "max":
                return max(float(np.max(each)) for each in series)
            case "min":
                return min(float(np.min(each)) for each in series)
            case "mean":
                return self._mean(one)
            case "rms":
                return float(np.sqrt(self._mean(one * one)))
            case "first":
                return float(one[0])
            case "last":
                return float(one[-1])
            case "peak_to_peak":
                return float(np.ptp(one))
            case "rate":
                return float((one[-1] - one[0]) / span)
            case "frequency":
                return self._frequency(one)
        return self._phase(one, np.broadcast_to(np.asarray(series[1], dtype=float), one.shape))

    def _mean(self, series: Values) -> float:
        return float(np.trapezoid(series, self.time) / (self.time[-1] - self.time[0]))

    def _frequency(self, series: Values) -> float:
        """Frequency [Hz] from the first to the last upward crossing of the middle value."""
        swing = series - 0.5 * (series.max() + series.min())
        up = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
        if len(up) < 2:
            raise Window.UndefinedError(
                "has no frequency: it crosses its middle value upwards less than twice; run longer"
            )
        part = swing[up] / (swing[up] - swing[up + 1])
        crossings = self.time[up] + part * (self.time[up + 1] - self.time[up])
        return float((len(up) - 1) / (crossings[-1] - crossings[0]))

    def _phase(self, series: Values, behind: Values) -> float:
        """Lag [rad] of the fundamental of `series` behind that of `behind`, from -pi/2 on."""
        if self.drive <= 0.0:
            raise Window.UndefinedError(
                "has no phase: there is no drive's frequency; give time.frequency"
            )
        push, response = self._fundamental(behind), self._fundamental(series)
        if self._is_still(push, behind) or self._is_still(response, series):
            raise Window.UndefinedError(
                "has no phase: one of the two does not swing at the drive's frequency"
            )
        lag = float(np.angle(push / response))
        return lag if lag > -0.5 * np.pi else lag + 2.0 * np.pi

    def _is_still(self, fundamental: complex, series: Values) -> bool:
        """Whether a fundamental is nothing but the rounding of its series."""
        span = float(self.time[-1] - self.time[0])
        return abs(fundamental) <= 1e-12 * span * float(np.max(np.abs(series)))

    def _fundamental(self, series: Values) -> complex:
        """Fourier coefficient at the drive's frequency over the window."""
        turn = np.exp(-2j * np.pi * self.drive * self.time)
        return complex(np.trapezoid((series - self._mean(series)) * turn, self.time))
