"""The numbers that matter of a run, taken over its last whole cycles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Metric:
    """One figure of the table: name, value in SI, unit; and how it is shown."""

    name: str
    value: float
    unit: str
    shown: str


def metrics(data: xarray.Dataset, cycles: int = 5) -> list[Metric]:
    """Metrics for which the dataset has the variables, over its last `cycles` cycles.

    Strokes and travel are peak to peak; phase is that of the fundamental of the travel
    behind the fundamental of the drive V_top^2 - V_bottom^2; powers are differences of
    energies over the window, so they miss nothing between samples.
    """
    if data.sizes["time"] < 3:
        return []
    return list(_found(_Window(data, cycles)))


def _found(w: _Window) -> Iterator[Metric]:
    angle, travel = w.first("flap_angle"), w.first("displacement")
    if angle is not None:
        stroke = float(np.ptp(angle))
        yield Metric("flapping stroke", stroke, "rad", f"{np.degrees(stroke):.2f} deg")
    if travel is not None:
        size = float(np.ptp(travel))
        yield Metric("travel", size, "m", f"{1e3 * size:.3f} mm")
    moving = travel if travel is not None else angle
    if moving is not None:
        frequency = w.frequency_of(moving)
        if frequency > 0.0:
            yield Metric("frequency", frequency, "Hz", f"{frequency:.3f} Hz")
        phase = w.phase_of(moving)
        if phase is not None:
            yield Metric("phase", phase, "rad", f"{np.degrees(phase):.1f} deg")
    for name, label in (("voltage", "peak voltage"), ("current", "peak current")):
        peak = w.peak(name)
        if peak is not None:
            unit, scale, symbol = ("V", 1.0, "V") if name == "voltage" else ("A", 1e3, "mA")
            yield Metric(label, peak, unit, f"{scale * peak:.2f} {symbol}")
    for name, label in (
        ("supplied_energy", "electrical power"),
        ("force_work", "mechanical power"),
        ("load_work", "aerodynamic power"),
    ):
        power = w.rate(name)
        if power is not None:
            yield Metric(label, power, "W", f"{1e3 * power:.3f} mW")
    lift = w.first("lift")
    if lift is not None:
        mean = w.mean(lift)
        yield Metric("mean lift", mean, "N", f"{1e6 * mean / 9.80665:.1f} mg")


class _Window:
    """The last whole cycles of a dataset."""

    def __init__(self, data: xarray.Dataset, cycles: int) -> None:
        time = np.asarray(data["time"].values, dtype=float)
        self.drive = float(data.attrs.get("frequency", 0.0))
        begin = time[0]
        if self.drive > 0.0:
            begin = max(begin, time[-1] - cycles / self.drive - 1e-9)
        first = int(np.searchsorted(time, begin))
        self.time = time[first:]
        self.data = data.isel(time=slice(first, None))

    def all(self, variable: str) -> list[Values]:
        """Series of all variables of this name, whatever the component and port."""
        names = [str(n) for n in self.data.data_vars]
        matching = [n for n in names if n.rpartition(".")[2] == variable]
        return [np.asarray(self.data[n].values, dtype=float) for n in matching]

    def first(self, variable: str) -> Values | None:
        found = self.all(variable)
        return found[0] if found else None

    def mean(self, series: Values) -> float:
        return float(np.trapezoid(series, self.time) / (self.time[-1] - self.time[0]))

    def peak(self, variable: str) -> float | None:
        """Largest magnitude, from the peak of each step where that is recorded."""
        names = [str(n) for n in self.data.data_vars]
        wanted = [n for n in names if n.endswith(f"_peak_{variable}")]
        wanted = wanted or [n for n in names if n.endswith((f".{variable}", f"_{variable}"))]
        series = [np.asarray(self.data[n].values) for n in wanted]
        return max((float(np.max(np.abs(s))) for s in series), default=None)

    def rate(self, variable: str) -> float | None:
        series = self.first(variable)
        if series is None:
            return None
        return float((series[-1] - series[0]) / (self.time[-1] - self.time[0]))

    def frequency_of(self, series: Values) -> float:
        """Frequency from the first to the last upward crossing of the mean; 0 without two."""
        swing = series - 0.5 * (series.max() + series.min())
        up = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
        if len(up) < 2:
            return 0.0
        part = swing[up] / (swing[up] - swing[up + 1])
        crossings = self.time[up] + part * (self.time[up + 1] - self.time[up])
        return float((len(up) - 1) / (crossings[-1] - crossings[0]))

    def phase_of(self, series: Values) -> float | None:
        """Lag [rad] of the fundamental of `series` behind that of V_top^2 - V_bottom^2."""
        voltages = self.all("voltage")
        if self.drive <= 0.0 or len(voltages) != 2:
            return None
        push = self._fundamental(voltages[0] ** 2 - voltages[1] ** 2)
        response = self._fundamental(series)
        if abs(push) == 0.0 or abs(response) == 0.0:
            return None
        lag = float(np.angle(push / response))
        return lag if lag > -0.5 * np.pi else lag + 2.0 * np.pi

    def _fundamental(self, series: Values) -> complex:
        """Fourier coefficient at the drive's frequency over the window."""
        turn = np.exp(-2j * np.pi * self.drive * self.time)
        return complex(np.trapezoid((series - self.mean(series)) * turn, self.time))
