"""Numbers of a run, as the figures ask for them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .job import Answer

Values = NDArray[np.float64]


def amplitude(answer: Answer) -> float:
    """Half of the travel, peak to peak [m]."""
    return 0.5 * answer.metrics["travel"]


def lag(answer: Answer) -> float:
    """Phase of the travel behind V_top^2 - V_bottom^2 [rad]."""
    return answer.metrics.get("phase", math.nan)


def stroke(answer: Answer) -> float:
    """Flapping stroke, peak to peak [rad]."""
    return answer.metrics["flapping stroke"]


def power(answer: Answer) -> float:
    """Mean over time of the positive part of M x'' x' [W].

    M x'' x' is the rate of the kinetic energy, so this is the sum of that energy's rises over
    the time; 2 f E_max for a harmonic motion. The mean of the magnitude is twice as much, that of
    M x'' x' itself is zero over a period.
    """
    return _rises(answer, "kinetic_energy")


def gross(answer: Answer) -> float:
    """Mean power into both electrodes where the amplifier takes nothing back [W].

    Of each channel by itself, sampled: while one electrode fills the other empties, and their sum
    would hide it. What the resistance takes is not in it.
    """
    total = 0.0
    for channel in ("top", "bottom"):
        into = answer.series(f"{channel}.voltage") * answer.series(f"{channel}_current")
        total += float(np.trapezoid(np.maximum(into, 0.0), answer.times))
    return total / _span(answer)


def net(answer: Answer) -> float:
    """Mean power out of the amplifier less what comes back [W]."""
    energy = answer.series("supplied_energy")
    return float(energy[-1] - energy[0]) / _span(answer)


def lift(answer: Answer) -> float:
    """Mean lift of the wings [N]."""
    return answer.metrics["mean lift"]


def harmonics(times: Values, series: Values, frequency: float, most: int = 9) -> float:
    """Root sum square of the harmonics from the second on, of the fundamental."""
    sizes = [abs(fourier(times, series, k * frequency)) for k in range(1, most + 1)]
    return math.sqrt(sum(size * size for size in sizes[1:])) / sizes[0]


def fourier(times: Values, series: Values, frequency: float) -> complex:
    """Fourier coefficient of a series at a frequency over its whole cycles."""
    swing = series - np.trapezoid(series, times) / (times[-1] - times[0])
    turned = swing * np.exp(-2j * np.pi * frequency * times)
    return complex(np.trapezoid(turned, times))


def _rises(answer: Answer, name: str) -> float:
    steps = np.diff(answer.series(name))
    return float(steps[steps > 0.0].sum()) / _span(answer)


def _span(answer: Answer) -> float:
    return float(answer.times[-1] - answer.times[0])
