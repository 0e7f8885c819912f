"""A recording: no inputs, outputs by time alone.

The time of the record is that of the run less `offset`. Outside of the record its ends are held or
the values are zero, or a step there fails, unless the record goes on periodically.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..quantity import parameter
from .data import BEGIN, END, GRAIN, PERIOD
from .generated_outputs import Output, outputs_at
from .interpolation import STOP

__all__ = ["Input", "Output", "Params", "State", "advance", "initial", "observe"]

OUTSIDE = ("hold", "zero", "stop")
ROUNDING = 1.0e-12


@dataclass(frozen=True)
class Params:
    """Where the record stands in time, and what holds outside of it."""

    offset: float = parameter(0.0, "s", "Added to the times of the record", "chosen: none")
    frequency: float = parameter(
        18.0,
        "Hz",
        "Frequency of the cycle that was recorded, for who counts in cycles; 0 where unknown",
        "chosen: of the sample, that of figure 11 with full wings",
        least=0.0,
    )
    before: float = parameter(
        1.0,
        "1",
        "What holds before the record: its first values, zero, or nothing, which stops the run",
        "chosen: hold",
        choices=OUTSIDE,
    )
    after: float = parameter(
        3.0,
        "1",
        "What holds after the record: its last values, zero, or nothing, which stops the run",
        "chosen: stop",
        choices=OUTSIDE,
    )


@dataclass(frozen=True)
class Input:
    """None: a recording follows nothing."""


@dataclass(frozen=True)
class State:
    """Size of the step just taken [s], for whose sake curvatures are what they are."""

    size: float


def near(time: float) -> float:
    """Distance [s] to an end of the record that counts as being at it."""
    return GRAIN + ROUNDING * math.fabs(time)


def initial(p: Params, u: Input, t: float) -> State:
    """`ValueError` before the record where nothing holds there."""
    if PERIOD <= 0.0 and p.before == STOP and t - p.offset < BEGIN - near(t):
        raise ValueError("the recording begins later: before = hold or zero says what holds")
    return State(size=0.0)


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Go on in time; `ValueError` outside of the record where nothing holds there."""
    after = t + h
    if PERIOD <= 0.0 and p.after == STOP and after - p.offset > END + near(after):
        raise ValueError("the recording has ended: after = hold or zero says what holds then")
    return State(size=h)


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    """Columns and the members of laws that follow from them."""
    return outputs_at(t, p.offset, x.size, p.before, p.after)
