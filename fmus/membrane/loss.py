"""Relaxation branches: a loss factor that grows as f^0.35 from 1 to 100 Hz.

Four Maxwell elements beside the elastic film. With u the branch force per unit of
eta K, u_i' = g_i v - u_i / tau_i; weights and times are a non-negative least-squares fit of
sum g_i w tau_i / (1 + w^2 tau_i^2) = (f / 52 Hz)^0.35, within 2 % from 1 to 100 Hz. By
causality the branches also stiffen the film: at 52 Hz by 1.41 eta K, at 1 Hz by 0.15 eta K.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

REFERENCE = 52.0
EXPONENT = 0.35
WEIGHTS = (0.28834076, 0.45229668, 0.80197394, 2.46990366)
TIMES = (
    1.0 / (2.0 * math.pi * 1.06265857),
    1.0 / (2.0 * math.pi * 6.21446501),
    1.0 / (2.0 * math.pi * 36.34241186),
    1.0 / (2.0 * math.pi * 212.53171384),
)


@dataclass(frozen=True)
class Branches:
    """Branch forces over eta K [m] and the loss over eta K [m2]."""

    u0: float
    u1: float
    u2: float
    u3: float
    loss: float


@dataclass(frozen=True)
class Reaction:
    """Law of the sum of branch forces over eta K: value [m], stiffness [1], and the rate [m/s]
    and curvature [m/s2] in time along the motion at constant velocity."""

    value: float
    stiffness: float
    rate: float
    curvature: float


def scale(loss_factor: float, frequency: float) -> float:
    """eta at 52 Hz from a loss factor given at another frequency."""
    return loss_factor * math.exp(EXPONENT * math.log(REFERENCE / frequency))


def storage(frequency: float) -> float:
    """Stiffening by the branches at a frequency [Hz], over eta K."""
    total = 0.0
    for i in range(4):
        wt = 2.0 * math.pi * frequency * TIMES[i]
        total = total + WEIGHTS[i] * wt * wt / (1.0 + wt * wt)
    return total


def relaxed(u: float, i: int, v0: float, vm: float, v1: float, h: float) -> tuple[float, float]:
    """Branch `i` and its loss after `h` [s] with the velocity a parabola v0, vm (middle), v1.

    Exact in the decay, so any step is stable: u(h) = u e^-z + g int v(s) e^-(h-s)/tau ds, the
    integral of the parabola in closed form.
    """
    tau = TIMES[i]
    z = h / tau
    fade = math.exp(-z)
    a1 = 4.0 * vm - 3.0 * v0 - v1
    a2 = 2.0 * (v0 + v1 - 2.0 * vm)
    w0 = -math.expm1(-z)
    if z < 0.01:
        w1 = z * (0.5 - z * (1.0 / 6.0 - z / 24.0))
        w2 = z * (1.0 / 3.0 - z * (1.0 / 12.0 - z / 60.0))
    else:
        w1 = 1.0 - w0 / z
        w2 = 1.0 - 2.0 * w1 / z
    after = u * fade + WEIGHTS[i] * tau * (v0 * w0 + a1 * w1 + a2 * w2)
    steady = WEIGHTS[i] * tau * vm
    first = u - steady
    last = after - steady
    square = steady * steady * h
    if z < 1.0:
        middle = 0.5 * (u + after)
        square = (u * u + 4.0 * middle * middle + after * after) * h / 6.0
    else:
        square = square + 2.0 * steady * (first - last) * tau
        square = square + 0.5 * tau * (first * first - last * last)
    return after, square / (WEIGHTS[i] * tau)


def moved(b: Branches, v0: float, vm: float, v1: float, h: float) -> Branches:
    """All branches after `h` [s]."""
    if h <= 0.0:
        return b
    u0, l0 = relaxed(b.u0, 0, v0, vm, v1, h)
    u1, l1 = relaxed(b.u1, 1, v0, vm, v1, h)
    u2, l2 = relaxed(b.u2, 2, v0, vm, v1, h)
    u3, l3 = relaxed(b.u3, 3, v0, vm, v1, h)
    return Branches(u0=u0, u1=u1, u2=u2, u3=u3, loss=b.loss + l0 + l1 + l2 + l3)


def stored(b: Branches) -> float:
    """Elastic energy of the branches over eta K [m2]."""
    return 0.5 * (
        b.u0 * b.u0 / WEIGHTS[0]
        + b.u1 * b.u1 / WEIGHTS[1]
        + b.u2 * b.u2 / WEIGHTS[2]
        + b.u3 * b.u3 / WEIGHTS[3]
    )


def branch(
    i: int, before: float, after: float, velocity: float, ahead: float, step: float
) -> tuple[float, float, float]:
    """Stiffness, rate and curvature of branch `i`.

    Over a step the branch follows u' = g v - u/tau. Along constant velocity that is known:
    its rate at the end and, where it was carried `ahead`, the curvature that gives its mean.
    A change of velocity by a s moves it by g a tau^2 (z - 1 + e^-z), z = step/tau, which a
    spring of 2 g (z - 1 + e^-z)/z^2 gives too: g for short steps, 2 g tau/step for long ones.
    """
    g = WEIGHTS[i]
    tau = TIMES[i]
    z = step / tau
    stiffness = g
    if z > 1.0e-3:
        stiffness = 2.0 * g * (z + math.expm1(-z)) / (z * z)
    rate = g * velocity - after / tau
    curvature = -0.5 * rate / tau
    if ahead > 0.0:
        steady = g * tau * velocity
        fade = ahead / tau
        mean = before
        if fade > 1.0e-9:
            mean = steady - (before - steady) * math.expm1(-fade) / fade
        curvature = 3.0 * (mean - after + 0.5 * rate * ahead) / (ahead * ahead)
        if fade < 1.0e-3:
            curvature = -0.5 * rate / tau
    return stiffness, rate - stiffness * velocity, curvature


def reaction(
    before: Branches, after: Branches, velocity: float, ahead: float, step: float
) -> Reaction:
    """Law of the branches carried `ahead` [s] at constant velocity, for steps of `step` [s]."""
    k0, r0, c0 = branch(0, before.u0, after.u0, velocity, ahead, step)
    k1, r1, c1 = branch(1, before.u1, after.u1, velocity, ahead, step)
    k2, r2, c2 = branch(2, before.u2, after.u2, velocity, ahead, step)
    k3, r3, c3 = branch(3, before.u3, after.u3, velocity, ahead, step)
    return Reaction(
        value=after.u0 + after.u1 + after.u2 + after.u3,
        stiffness=k0 + k1 + k2 + k3,
        rate=r0 + r1 + r2 + r3,
        curvature=c0 + c1 + c2 + c3,
    )
