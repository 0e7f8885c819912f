"""One RC electrode pair behind the amplifier: charge is the state, energy is kept account of.

R q' = V_a(t) - V(q, t), where V inverts the charge law of the membrane or spring,
q = Q + i_m s + k s^2 + (C + C' s)(V - V_r), s the time since it held. Charge is what is
integrated, so none is lost when the law is renewed. Within a step C stands still at its
middle value, which costs third order and keeps the solution in closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import mean_square
from .relaxation import relaxed, segment

IDEAL = 1.0e-3
"""Resistance [Ohm] at and below which an electrode is ideal; the energy of a jump stays exact."""

ENDLESS = 1.0e60
"""Charge [C] that no electrode has: what follows from an input beyond all measure."""

MOST_STRETCHES = 1.0e4
"""Stretches of one piece of the drive: a limit is met and left a few times in it."""

ITERATIONS = 20

SMOOTH = 0.05
"""Span over time constant below which the exchange is a smooth integrand."""

NODE = 0.7745966692414834
"""Outer node of the three-point Gauss rule, sqrt(3/5)."""


@dataclass(frozen=True)
class Law:
    """Charge law Q + i_m s + k s^2 + (C + C' s - 2 B V_r^2)(V - V_r) + B (V^2 - V_r^2) V, with s
    the time since it held; B is the derivative of Q/V by V^2."""

    charge: float
    capacitance: float
    motional_current: float
    capacitance_rate: float
    charge_curvature: float
    by_square: float
    reference_voltage: float


@dataclass(frozen=True)
class Electrode:
    """Charge [C], current at the end and largest [A], integral of V^2 [V2 s], energies [J]."""

    charge: float
    current: float
    peak_current: float
    square: float
    supplied: float
    loss: float


def shifted(law: Law, s: float) -> float:
    """Charge [C] at the reference voltage, `s` [s] after the law held."""
    return law.charge + (law.motional_current + law.charge_curvature * s) * s


def charge_at(law: Law, level: float, s: float) -> float:
    """Charge [C] at a voltage, `s` [s] after the law held."""
    reference = law.reference_voltage
    slope = law.capacitance + law.capacitance_rate * s
    slope = slope - 2.0 * law.by_square * reference * reference
    bend = law.by_square * (level * level - reference * reference) * level
    return shifted(law, s) + slope * (level - reference) + bend


def slope_at(law: Law, level: float, s: float) -> float:
    """dQ/dV [F] at a voltage; `ValueError` where it is no longer positive."""
    reference = law.reference_voltage
    slope = law.capacitance + law.capacitance_rate * s
    slope = slope + 3.0 * law.by_square * (level * level - reference * reference)
    if slope <= 0.0:
        raise ValueError("an electrode's capacitance falls to zero within the step")
    return slope


def field_energy(law: Law, level: float, s: float) -> float:
    """Energy [J] that charging from zero volts takes at this instant by the law: the integral of
    V dQ, with dQ/dV = c + 3 B V^2."""
    reference = law.reference_voltage
    slope = law.capacitance + law.capacitance_rate * s
    slope = slope - 3.0 * law.by_square * reference * reference
    square = level * level
    return (0.5 * slope + 0.75 * law.by_square * square) * square


def voltage(law: Law, charge: float, s: float) -> float:
    """Voltage [V] at a charge, by Newton's method; one iteration where Q is linear in V."""
    level = law.reference_voltage
    for i in range(ITERATIONS):
        change = (charge - charge_at(law, level, s)) / slope_at(law, level, s)
        level = level + change
        if law.by_square == 0.0 or math.fabs(change) < 1.0e-10 * (1.0 + math.fabs(level)):
            break
    return level


def voltage_rate(law: Law, level: float, current: float, s: float) -> float:
    """dV/dt [V/s] at a voltage and current."""
    moved = law.motional_current + 2.0 * law.charge_curvature * s
    moved = moved + law.capacitance_rate * (level - law.reference_voltage)
    return (current - moved) / slope_at(law, level, s)


def chord(law: Law, charge: float, aim: float, s: float) -> Law:
    """Law that is linear in V from the present charge to the voltage aimed at, `s` after the
    law held: exact at both ends, where a tangent would miss the charge of a large jump."""
    here = voltage(law, charge, s)
    slope = slope_at(law, here, s)
    if math.fabs(aim - here) > 1.0e-6 * (1.0 + math.fabs(here)):
        slope = (charge_at(law, aim, s) - charge) / (aim - here)
    moved = law.motional_current + 2.0 * law.charge_curvature * s
    return Law(
        charge=charge - moved * s,
        capacitance=max(slope, 0.1 * law.capacitance),
        motional_current=moved,
        capacitance_rate=0.0,
        charge_curvature=0.0,
        by_square=0.0,
        reference_voltage=here,
    )


def frozen(law: Law, s: float) -> Law:
    """The law with its capacitance held at the value it has at `s`; a tenth at the least."""
    return Law(
        charge=law.charge,
        capacitance=max(law.capacitance + law.capacitance_rate * s, 0.1 * law.capacitance),
        motional_current=law.motional_current,
        capacitance_rate=0.0,
        charge_curvature=law.charge_curvature,
        by_square=0.0,
        reference_voltage=law.reference_voltage,
    )


def charged(
    e: Electrode,
    law: Law,
    since: float,
    resistance: float,
    limit: float,
    v0: float,
    v1: float,
    v2: float,
    span: float,
) -> Electrode:
    """Electrode after `span` [s] behind an amplifier at v0 + v1 t + v2 t^2 [V].

    The law held `since` [s] before the start of the span. `limit` bounds the current [A].
    Solved exactly stretch by stretch: free relaxation towards the charge at which V equals
    the amplifier's voltage, or constant current.
    """
    r = max(resistance, IDEAL)
    lag = r * law.capacitance
    left = span
    stretches = 0.0
    while left > 0.0:
        stretches = stretches + 1.0
        if stretches > MOST_STRETCHES:
            raise ValueError("an electrode's charge law is too stiff to follow")
        if not math.fabs(e.charge) < ENDLESS:
            raise ValueError("the charge on an electrode leaves all bounds")
        bend = law.charge_curvature
        g0 = charge_at(law, v0, since)
        g1 = law.capacitance * v1 + law.motional_current + 2.0 * bend * since
        g2 = law.capacitance * v2 + bend
        duration, mode = segment(e.charge, g0, g1, g2, lag, limit, left)
        if mode == 0.0:
            e = free(e, law, since, r, g0, g1, g2, lag, duration)
        else:
            e = driven(e, law, since, r, mode * limit, duration)
        since = since + duration
        v0 = v0 + (v1 + v2 * duration) * duration
        v1 = v1 + 2.0 * v2 * duration
        left = left - max(duration, 1.0e-6 * span)
    return e


def driven(
    e: Electrode, law: Law, since: float, resistance: float, current: float, s: float
) -> Electrode:
    """Stretch of `s` at constant current: V is a parabola in time."""
    charge = e.charge + current * s
    first = voltage(law, e.charge, since)
    last = voltage(law, charge, since + s)
    middle = voltage(law, e.charge + 0.5 * current * s, since + 0.5 * s)
    mean = (first + 4.0 * middle + last) / 6.0
    loss = resistance * current * current * s
    return Electrode(
        charge=charge,
        current=current,
        peak_current=max(e.peak_current, math.fabs(current)),
        square=e.square + mean_square(first, last, mean) * s,
        supplied=e.supplied + mean * current * s + loss,
        loss=e.loss + loss,
    )


def free(
    e: Electrode,
    law: Law,
    since: float,
    resistance: float,
    g0: float,
    g1: float,
    g2: float,
    lag: float,
    s: float,
) -> Electrode:
    """Stretch of `s` of free relaxation towards the charge g0 + g1 t + g2 t^2.

    The integrals of V^2, V i and i^2 come from a Gauss rule where the relaxation is smooth
    over the stretch; else q = parabola + A exp(-t/lag) and the products with the
    exponential are integrated in closed form.
    """
    charge = relaxed(e.charge, g0, g1, g2, lag, s)
    first = (g0 - e.charge) / lag
    last = (g0 + (g1 + g2 * s) * s - charge) / lag
    curve = 0.0
    faded = 0.0
    if s > SMOOTH * lag:
        curve = e.charge - (g0 - lag * g1 + 2.0 * lag * lag * g2)
        faded = math.exp(-s / lag)
        last = g1 + 2.0 * g2 * (s - lag) - curve * faded / lag
    square = 0.0
    work = 0.0
    heat = 0.0
    for i in range(3):
        node = 0.5 * s * (1.0 + NODE * float(i - 1))
        weight = 5.0 / 18.0 * s
        if i == 1:
            weight = 8.0 / 18.0 * s
        if s > SMOOTH * lag:
            held = g0 + (g1 + g2 * node) * node - lag * (g1 + 2.0 * g2 * (node - lag))
            flow = g1 + 2.0 * g2 * (node - lag)
        else:
            held = relaxed(e.charge, g0, g1, g2, lag, node)
            flow = (g0 + (g1 + g2 * node) * node - held) / lag
        v = voltage(law, held, since + node)
        square = square + weight * v * v
        work = work + weight * v * flow
        heat = heat + weight * flow * flow
    if s > SMOOTH * lag:
        m0 = lag * (1.0 - faded)
        m1 = lag * (m0 - s * faded)
        m2 = lag * (2.0 * m1 - s * s * faded)
        double = 0.5 * lag * (1.0 - faded * faded)
        rise = curve / law.capacitance
        drain = -curve / lag
        p0 = voltage(law, g0 - lag * g1 + 2.0 * lag * lag * g2, since)
        moved = law.motional_current + 2.0 * law.charge_curvature * since
        p1 = (g1 - 2.0 * lag * g2 - moved) / law.capacitance
        p2 = (g2 - law.charge_curvature) / law.capacitance
        i0 = g1 - 2.0 * lag * g2
        i1 = 2.0 * g2
        product = p0 * m0 + p1 * m1 + p2 * m2
        square = square + 2.0 * rise * product + rise * rise * double
        work = work + drain * product + rise * (i0 * m0 + i1 * m1) + rise * drain * double
        heat = heat + 2.0 * drain * (i0 * m0 + i1 * m1) + drain * drain * double
    return Electrode(
        charge=charge,
        current=last,
        peak_current=max(e.peak_current, max(math.fabs(first), math.fabs(last))),
        square=e.square + square,
        supplied=e.supplied + work + resistance * heat,
        loss=e.loss + resistance * heat,
    )
