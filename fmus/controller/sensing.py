"""Samples of a periodic motion, and its first harmonic over a drive cycle.

A sample is taken in the middle of each of `SAMPLES` parts of a half cycle, wherever the
communication points lie: between them the flap angle is the cubic through angles and rates, the
capacitance the line through two measurements of one cone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import elapsed
from .interface import CAPACITANCE, Input, Params

SAMPLES = 16.0
"""Samples of a half cycle."""

CHARGED = 0.5
"""Share of the drive's voltage from which on a cone's capacitance is read."""

MODULUS = 2147483647.0
MULTIPLIER = 16807.0


@dataclass(frozen=True)
class Measure:
    """What a sensor gave: time [s], flap angle [rad] and rate [rad/s], or relative capacitance.

    `half` is the half cycle (0 top, 1 bottom) whose cone was read, -1 where none was.
    """

    time: float
    value: float
    rate: float
    half: float


@dataclass(frozen=True)
class Sums:
    """Sums over the samples of a cycle, against sine and cosine of the drive's phase."""

    sample: float
    taken: float
    sine: float
    cosine: float
    random: float


@dataclass(frozen=True)
class Stroke:
    """Lag behind the drive [rad] and peak-to-peak stroke [rad] of a cycle."""

    lag: float
    size: float


def relative_capacitance(p: Params, charge: float, voltage: float) -> float:
    """C/C_0 - 1 with C = Q/V and C_0 that of flap angle 0 at this voltage."""
    rest = p.rest_capacitance * (1.0 + p.capacitance_by_square * voltage * voltage)
    return charge / (voltage * rest) - 1.0


def measured(p: Params, u: Input, half: float, level: float, t: float) -> Measure:
    """What the sensor gives at `t` [s], in a half cycle that is driven at `level` [V]."""
    if p.sensor != CAPACITANCE:
        return Measure(
            time=t - elapsed(t, u.motion_reference_time),
            value=u.motion_flap_angle,
            rate=u.motion_flap_rate,
            half=half,
        )
    charge = u.top_charge
    voltage = u.top_reference_voltage
    time = t - elapsed(t, u.top_charge_time)
    if half > 0.5:
        charge = u.bottom_charge
        voltage = u.bottom_reference_voltage
        time = t - elapsed(t, u.bottom_charge_time)
    if level <= 0.0 or voltage < CHARGED * level:
        return Measure(time=time, value=0.0, rate=0.0, half=-1.0)
    return Measure(time=time, value=relative_capacitance(p, charge, voltage), rate=0.0, half=half)


def between(p: Params, a: Measure, b: Measure, t: float) -> float:
    """Value at `t` [s] by two measurements; beyond the later one it goes on as it moved last."""
    span = b.time - a.time
    if p.sensor == CAPACITANCE:
        if a.half != b.half or span <= 0.0:
            return b.value
        return b.value + (b.value - a.value) * (t - b.time) / span
    if t >= b.time or span <= 0.0:
        return b.value + b.rate * (t - b.time)
    s = (t - a.time) / span
    r = 1.0 - s
    return r * r * ((1.0 + 2.0 * s) * a.value + s * span * a.rate) + s * s * (
        (3.0 - 2.0 * s) * b.value - r * span * b.rate
    )


def angle_of(p: Params, half: float, relative: float) -> float:
    """Flap angle [rad] by the relative capacitance of the cone that is charged.

    The bottom cone shortens where the top one lengthens: it gives the mirrored angle.
    """
    angle = (p.angle_slope + (p.angle_curvature + p.angle_cubic * relative) * relative) * relative
    if half > 0.5:
        return -angle
    return angle


def following(random: float) -> float:
    """Next of a sequence of whole numbers from 1 to 2^31 - 2 (Park and Miller 1988)."""
    return (MULTIPLIER * random) % MODULUS


def normal(first: float, second: float) -> float:
    """Normal deviate by two numbers of the sequence (Box and Muller 1958)."""
    return math.sqrt(-2.0 * math.log(first / MODULUS)) * math.cos(2.0 * math.pi * second / MODULUS)


def sampled(
    p: Params, x: Sums, a: Measure, b: Measure, half: float, start: float, span: float, until: float
) -> Sums:
    """Sums with the samples of a half cycle taken that are due `until` [s].

    The half cycle goes from `start` over `span` [s].
    """
    sample = x.sample
    taken = x.taken
    sine = x.sine
    cosine = x.cosine
    random = x.random
    while sample < SAMPLES:
        share = (sample + 0.5) / SAMPLES
        time = start + share * span
        if time > until:
            break
        sample = sample + 1.0
        value = between(p, a, b, time)
        if p.sensor == CAPACITANCE:
            if p.noise > 0.0:
                first = following(random)
                random = following(first)
                value = value + p.noise * (1.0 + value) * normal(first, random)
            if b.half < 0.0:
                continue
            value = angle_of(p, b.half, value)
        phase = math.pi * (half + share)
        taken = taken + 1.0
        sine = sine + value * math.sin(phase)
        cosine = cosine + value * math.cos(phase)
    return Sums(
        sample=sample,
        taken=taken,
        sine=sine,
        cosine=cosine,
        random=random,
    )


def stroke_of(x: Sums) -> Stroke:
    """Lag and stroke of the motion y = Y sin(phase - lag) whose first harmonic the sums hold.

    The stroke is 2 Y: peak to peak but for the higher harmonics.
    """
    if x.taken < SAMPLES:
        return Stroke(lag=0.0, size=0.0)
    lag = math.atan2(-x.cosine, x.sine)
    if lag < -0.5 * math.pi:
        lag = lag + 2.0 * math.pi
    size = 4.0 / x.taken * math.sqrt(x.sine * x.sine + x.cosine * x.cosine)
    return Stroke(lag=lag, size=size)
