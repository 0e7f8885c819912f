"""A measured relation: outputs that follow one or two inputs, without a state.

    y = f(u)   or   y = f(u, v)

Where an output and an argument are a force and a displacement or velocity, or a torque or added
inertia and a flap rate, the table hands over the slope as the member of the law that it is; every
other slope is an output of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..quantity import parameter
from .generated_ports import Input, Output, check_inside, outputs_at
from .relation import STOP

__all__ = ["Input", "Output", "Params", "State", "advance", "initial", "observe"]


@dataclass(frozen=True)
class Params:
    """How points are joined, and what holds outside of them."""

    interpolation: float = parameter(
        1.0,
        "1",
        "Monotone cubics through the points, or straight lines",
        "chosen: cubic",
        choices=("cubic", "linear"),
    )
    outside: float = parameter(
        1.0,
        "1",
        "What holds outside of the table: nothing, which stops the run, the value at its edge, or"
        " the straight line that goes on there",
        "chosen: stop",
        choices=("stop", "hold", "extend"),
    )


@dataclass(frozen=True)
class State:
    """A table has none."""

    nothing: float


def initial(p: Params, u: Input, t: float) -> State:
    """`ValueError` outside of the table where nothing holds there."""
    if p.outside == STOP:
        check_inside(u)
    return State(nothing=0.0)


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """`ValueError` outside of the table where nothing holds there."""
    if p.outside == STOP:
        check_inside(u)
    return x


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    """The relation at the inputs as they are, with its slopes."""
    return outputs_at(u, p.interpolation, p.outside)
