"""Loops of the controller: by the averaged linear model, and as a run shows them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..job import Answer

if TYPE_CHECKING:
    import control

Values = NDArray[np.float64]
CHANNELS = ("frequency", "drive")
OUTPUTS = ("lag", "stroke")


@dataclass(frozen=True)
class Gains:
    """Proportional and integral gain of a loop."""

    proportional: float
    integral: float

    def law(self, period: float) -> control.StateSpace:
        """From error to command, once a cycle: k + K z/(z - 1)."""
        import control

        both = [self.proportional + self.integral, -self.proportional]
        return control.ss(control.tf(both, [1.0, -1.0], period))


@dataclass(frozen=True)
class Margin:
    """Gain margin, phase margin [rad] and crossover [Hz] of a loop.

    The gain margin is infinite where no gain makes the loop unstable, NaN where it is not known.
    """

    gain: float
    phase: float
    crossover: float


def plant(answer: Answer, period: float) -> control.StateSpace:
    """From frequency and drive to lag and stroke, once a cycle of `period` [s].

    A nudge that is given in mid-cycle waits for the end of it. The controller acts at that very
    end: of the model z^-1 is taken out, x+ = A x + B u, y = C (A x + B u).
    """
    import control

    order = int(math.sqrt(len(answer.rows["a"])))
    a = answer.rows["a"].reshape(order, order)
    b = answer.rows["b"].reshape(order, len(CHANNELS))
    c = answer.rows["c"].reshape(len(OUTPUTS), order)
    return control.ss(a, b, c @ a, c @ b, period)


def loop(system: control.StateSpace, gains: Sequence[Gains], which: int) -> control.StateSpace:
    """The loop of one channel, cut at its command, with the other one closed."""
    import control

    period = float(system.dt)
    laws = [each.law(period) for each in gains]
    none = control.ss([], [], [], [[0.0]], period)
    other = [law if k != which else none for k, law in enumerate(laws)]
    closed = control.feedback(system, control.append(*other))
    return control.series(closed[which, which], laws[which])


def closed(system: control.StateSpace, gains: Sequence[Gains]) -> control.StateSpace:
    """From excitations, added to the commands, to lag and stroke with both loops closed."""
    import control

    laws = control.append(*(each.law(float(system.dt)) for each in gains))
    return control.feedback(system, laws)


def predicted(system: control.StateSpace) -> Margin:
    """Margins of a loop by its model.

    Where its phase turns at no frequency but 0, that is the endless gain of its integrators there.
    """
    import control

    _, phase, _, crossover = control.margin(system)
    gains, _, _, turns, _, _ = control.stability_margins(system, returnall=True)
    gain = min(gains[(turns > 0.0) & (gains > 1.0)], default=math.inf)
    return Margin(float(gain), math.radians(float(phase)), float(crossover) / (2.0 * math.pi))


def measured(total: Values, excitation: float, period: float) -> Margin:
    """Phase margin of a loop from its command, once a cycle of `period` [s], after a step.

    The command is that of the loop plus the excitation, both counted from before the step. With
    integral action it returns, so the differences of both have a spectrum, and
    L(w) = -(own)/(total) at every frequency.
    """
    steps = np.diff(total, prepend=0.0)
    own = np.diff(total - excitation, prepend=0.0)
    count = np.arange(len(steps))
    rates = np.linspace(0.01, 0.5, 4901) / period
    turned = np.exp(-2j * np.pi * np.outer(rates * period, count))
    response = -(turned @ own) / (turned @ steps)
    passed = np.flatnonzero((np.abs(response[:-1]) > 1.0) & (np.abs(response[1:]) <= 1.0))
    if not len(passed):
        return Margin(math.nan, math.nan, math.nan)
    at = int(passed[0])
    phase = math.pi + float(np.unwrap(np.angle(response))[at])
    return Margin(math.nan, phase, float(rates[at]))
