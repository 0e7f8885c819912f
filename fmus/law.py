"""Evaluation of what a law-carrying port hands over.

A port carries a value together with how it changes, and the point at which it holds.
Displacement, velocity and time enter through

    F(x, v, t) = value - stiffness (x - x0) - damping (v - v0) + rate s + curvature s^2,
    s = t - t0,

so that a receiver that integrates over a step sees the partner react within it.
"""

from __future__ import annotations

import math

from .quantity import NO_REFERENCE


def elapsed(time: float, reference_time: float) -> float:
    """Time [s] since a port's values held; 0 where the sender gave no reference time.

    Zero counts as none: other masters set inputs that nothing feeds to zero, and a law that really
    holds at t = 0 is used in the first step alone.
    """
    if reference_time <= 0.5 * NO_REFERENCE or reference_time == 0.0:
        return 0.0
    return time - reference_time


def mean_square(first: float, last: float, mean: float) -> float:
    """Mean of y^2 over an interval, y taken as the parabola through both ends and its mean.

    With the Legendre coefficients d1 = (y1 - y0)/2 and d2 = (y0 + y1)/2 - m the mean is
    m^2 + d1^2/3 + d2^2/5; the error of the parabola is third order in the interval.
    """
    slope = 0.5 * (last - first)
    bulge = 0.5 * (first + last) - mean
    return mean * mean + slope * slope / 3.0 + bulge * bulge / 5.0


def acceleration_between(
    first: float, first_velocity: float, last: float, last_velocity: float, span: float
) -> float:
    """Acceleration [m/s2] at the end of a span between two motion samples; 0 without a span.

    Second derivative of the cubic through both displacements and velocities; its error is
    second order in the span.
    """
    if span <= 0.0:
        return 0.0
    mean = (last - first) / span
    return (2.0 * first_velocity + 4.0 * last_velocity - 6.0 * mean) / span


def force_at(
    value: float,
    stiffness: float,
    damping: float,
    rate: float,
    curvature: float,
    displacement: float,
    velocity: float,
    s: float,
) -> float:
    """Force of the law above [N]; displacement and velocity count from the reference point."""
    return value - stiffness * displacement - damping * velocity + (rate + curvature * s) * s


def drag_at(quadratic_drag: float, slope: float, reference_rate: float, flap_rate: float) -> float:
    """Torque -c(w) w |w| [N m] with c(w) = c + slope (w - w0), never below zero."""
    coefficient = max(0.0, quadratic_drag + slope * (flap_rate - reference_rate))
    return -coefficient * flap_rate * math.fabs(flap_rate)


def torque_at(
    torque: float,
    damping: float,
    quadratic_drag: float,
    slope: float,
    reference_rate: float,
    flap_rate: float,
) -> float:
    """Velocity-dependent torque of a `load` port [N m].

    torque - damping (w - w0) + D(w) - D(w0), D the drag law of :func:`drag_at`. Without
    coefficients it is the plain torque. The added inertia of the port comes on top, in the
    receiver.
    """
    return (
        torque
        - damping * (flap_rate - reference_rate)
        + drag_at(quadratic_drag, slope, reference_rate, flap_rate)
        - drag_at(quadratic_drag, slope, reference_rate, reference_rate)
    )


def inertia_at(
    added_inertia: float, slope: float, reference_rate: float, flap_rate: float
) -> float:
    """Added inertia [kg m2] at a flap rate [rad/s], linear about the reference, not negative."""
    return max(0.0, added_inertia + slope * (flap_rate - reference_rate))
