"""Where the supplied energy is: in the electrode's field, gone into motion, or lost.

At a fixed pose the field holds U = Q V - W, with the co-energy W(V, t) = integral of Q dV from
zero volts; the pose takes P = dW/dt at fixed V out of it as work. So along any path

    integral of V dQ = change of U + integral of P dt,

and what of the supply is neither of these is the loss. W and P come through the port at both
ends of a step, exact; only P in between is interpolated. A charge law known at one end alone
would miss the energy of a large jump by the film's curvature.
"""

from __future__ import annotations

from dataclasses import dataclass

from .electrode import Law, field_energy, shifted, voltage

NONE = 1.0e-6
"""V^2 [V2] below which there is no field; and, of the larger one, below which it tells no ratio."""

APART = 0.25
"""Relative change of V^2 over a step above which P follows V^2 and not the clock."""


@dataclass(frozen=True)
class Coenergy:
    """Co-energy [J] at the reference voltage of a charge law, with its rate [W] and the coefficient
    of s^2 [W/s] at fixed voltage."""

    value: float
    rate: float
    curvature: float


@dataclass(frozen=True)
class Mark:
    """A communication point: V^2 [V2], power P into motion [W] and its rate at fixed V [W/s]."""

    square: float
    power: float
    power_rate: float


@dataclass(frozen=True)
class Account:
    """Work up to a mark [J], the mark, and integrals of V^2 and of t V^2 over the span since.

    `coupled` is 1 once a co-energy has come through the port.
    """

    delivered: float
    coupled: float
    square: float
    power: float
    power_rate: float
    span: float
    area: float
    moment: float


def mark_of(law: Law, w: Coenergy, age: float) -> Mark:
    """The communication point that lies `age` [s] after a law held."""
    reference = law.reference_voltage
    return Mark(
        square=reference * reference,
        power=w.rate + 2.0 * w.curvature * age,
        power_rate=2.0 * w.curvature,
    )


def work_until(a: Account, end: Mark) -> float:
    """Integral of P [J] from the account's mark to another one.

    P at the V^2 of either mark is a parabola in time; in between the two are weighted by V^2.
    In the clock's place come the mean of V^2 over the step and its first moment.
    """
    most = max(a.square, end.square)
    if a.span <= 0.0 or most <= NONE:
        return 0.0
    change = end.square - a.square
    alike = min(a.square, end.square) / most
    bend = 0.0
    turn = 0.0
    if end.square > NONE * most:
        bend = alike * (end.power * (a.square / end.square) - a.power - a.power_rate * a.span)
    if a.square > NONE * most:
        turn = a.power * (end.square / a.square) - end.power + end.power_rate * a.span
        turn = alike * turn
    whole = 0.5
    first = 1.0 / 3.0
    beside = 0.0
    if change > APART * most or change < -APART * most:
        whole = (a.area / a.span - a.square) / change
        first = (a.moment / (a.span * a.span) - 0.5 * a.square) / change
        whole = max(0.0, min(1.0, whole))
        first = max(0.0, min(0.5, first))
    else:
        mean = 0.5 * (a.square + end.square)
        beside = (a.area / a.span - mean) * 0.5 * (a.power + end.power) / mean
    second = first - whole / 6.0
    slope = a.power_rate * a.span
    fall = end.power_rate * a.span
    early = a.power * (1.0 - whole) + slope * (0.5 - first) + bend * (1.0 / 3.0 - second)
    late = end.power * whole - fall * (whole - first) + turn * (whole - 2.0 * first + second)
    return (early + late + beside) * a.span


def stored(law: Law, w: Coenergy, charge: float, age: float) -> float:
    """Energy [J] in the field at a charge, `age` [s] after the law held."""
    reference = law.reference_voltage
    coenergy = w.value + (w.rate + w.curvature * age) * age
    here = voltage(law, charge, age)
    beyond = field_energy(law, here, age) - field_energy(law, reference, age)
    return shifted(law, age) * reference - coenergy + beyond


def lost(
    a: Account, law: Law, w: Coenergy, charge: float, supplied: float, known: float, age: float
) -> float:
    """Loss [J] up to a communication point: supplied less stored less delivered.

    What is `known` by the resistance's own heat stays where no co-energy comes.
    """
    if a.coupled == 0.0 and w.value == 0.0:
        return known
    work = a.delivered + work_until(a, mark_of(law, w, age))
    return supplied - stored(law, w, charge, age) - work
