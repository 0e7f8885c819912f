"""Flap angle of the slider-crank and double rocker, with first and second derivatives.

The crank turns about the origin; the slider moves along y at x = -offset. In the neutral
pose (slider displacement 0) the crank is perpendicular to the slider's axis and the conrod
parallel to it; the coupler is perpendicular to the arm and to the rocker. Which of the five
printed lengths is which, and this pose, are inferred (docs/reference/model.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

SINGULAR = 0.3
"""Least sine of a transmission angle inside the usable range."""

SCAN = 1.0e-5
FARTHEST = 2.0e-2
DECAY = 5.0e-5
"""Length [m] over which the curvature fades outside the usable range."""


@dataclass(frozen=True)
class Geometry:
    """Lengths [m] of conrod, crank, bell-crank arm, coupler and rocker."""

    conrod: float
    crank: float
    arm: float
    coupler: float
    rocker: float


@dataclass(frozen=True)
class Range:
    """Usable range of the slider [m] with the flap angle and its derivatives at both ends."""

    lower: float
    lower_angle: float
    lower_slope: float
    lower_bend: float
    upper: float
    upper_angle: float
    upper_slope: float
    upper_bend: float


def closed_form(g: Geometry, displacement: float) -> tuple[float, float, float, float]:
    """Flap angle [rad], d/dx [rad/m], d2/dx2 [rad/m2] and the least sine of the two
    transmission angles at a slider displacement [m].

    The angles follow from the two loop closures; the derivatives from differentiating
    |slider - crank tip|^2 = conrod^2 and |arm tip - rocker tip|^2 = coupler^2 twice.
    Where a loop does not close all four are zero: a sine of 0 marks the pose as unusable.
    """
    reach = g.conrod + displacement
    distance2 = g.crank * g.crank + reach * reach
    cosine = (g.crank * g.crank + distance2 - g.conrod * g.conrod) / (
        2.0 * g.crank * math.sqrt(distance2)
    )
    if math.fabs(cosine) >= 1.0:
        return 0.0, 0.0, 0.0, 0.0
    crank_angle = math.atan2(reach, -g.crank) + math.acos(cosine)
    c1 = math.cos(crank_angle)
    s1 = math.sin(crank_angle)
    vx = -g.crank - g.crank * c1
    vy = reach - g.crank * s1
    first_moment = vy * c1 - vx * s1
    if first_moment == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    turn = vy / (g.crank * first_moment)
    along = vx * c1 + vy * s1
    bend = (
        1.0
        - 2.0 * g.crank * turn * c1
        + g.crank * g.crank * turn * turn
        + g.crank * turn * turn * along
    ) / (g.crank * first_moment)

    arm_angle = crank_angle - 0.5 * math.pi
    c2 = math.cos(arm_angle)
    s2 = math.sin(arm_angle)
    wx = g.arm * c2 - g.coupler
    wy = g.arm * s2 - g.arm + g.rocker
    span2 = wx * wx + wy * wy
    if span2 == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    cosine = (g.rocker * g.rocker + span2 - g.coupler * g.coupler) / (
        2.0 * g.rocker * math.sqrt(span2)
    )
    if math.fabs(cosine) >= 1.0:
        return 0.0, 0.0, 0.0, 0.0
    rocker_angle = math.atan2(wy, wx) - math.acos(cosine)
    c3 = math.cos(rocker_angle)
    s3 = math.sin(rocker_angle)
    ux = wx - g.rocker * c3
    uy = wy - g.rocker * s3
    second_moment = g.rocker * (uy * c3 - ux * s3)
    if second_moment == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    swing = g.arm * (uy * c2 - ux * s2) * turn / second_moment
    dx = -g.arm * s2 * turn + g.rocker * s3 * swing
    dy = g.arm * c2 * turn - g.rocker * c3 * swing
    bx = -g.arm * c2 * turn * turn - g.arm * s2 * bend + g.rocker * c3 * swing * swing
    by = -g.arm * s2 * turn * turn + g.arm * c2 * bend + g.rocker * s3 * swing * swing
    swing_bend = (dx * dx + dy * dy + ux * bx + uy * by) / second_moment
    sine = min(
        math.fabs(first_moment) / g.conrod,
        math.fabs(second_moment) / (g.rocker * g.coupler),
    )
    return 0.5 * math.pi - rocker_angle, -swing, -swing_bend, sine


def end_of_range(g: Geometry, side: float) -> float:
    """Largest usable displacement [m] on one side (+1, -1), scanned outwards from 0.

    Usable means that both loops close, both transmission angles keep a sine of at least
    `SINGULAR`, and the flap angle goes on growing with the displacement.
    """
    _, direction, _, sine = closed_form(g, 0.0)
    if sine < SINGULAR or direction == 0.0:
        raise ValueError("the linkage is singular in its neutral pose")
    reached = 0.0
    count = int(FARTHEST / SCAN)
    for i in range(count):
        displacement = side * SCAN * float(i + 1)
        _, slope, _, sine = closed_form(g, displacement)
        if sine < SINGULAR or slope * direction <= 0.0:
            break
        reached = displacement
    return reached


def usable_range(g: Geometry) -> Range:
    """Both ends of the usable range with the angle and its derivatives there."""
    lower = end_of_range(g, -1.0)
    upper = end_of_range(g, 1.0)
    lower_angle, lower_slope, lower_bend, _ = closed_form(g, lower)
    upper_angle, upper_slope, upper_bend, _ = closed_form(g, upper)
    return Range(
        lower=lower,
        lower_angle=lower_angle,
        lower_slope=lower_slope,
        lower_bend=lower_bend,
        upper=upper,
        upper_angle=upper_angle,
        upper_slope=upper_slope,
        upper_bend=upper_bend,
    )


def flap(g: Geometry, r: Range, displacement: float) -> tuple[float, float, float]:
    """Flap angle [rad] and its derivatives at any displacement [m].

    Inside the range the closed form; outside a C2 continuation whose curvature fades as
    exp(-s / DECAY) with the distance s from the end, so that a linkage driven through its
    stops stays finite. Results out there serve the integrator, not the reader.
    """
    if displacement > r.upper:
        return faded(r.upper_angle, r.upper_slope, r.upper_bend, displacement - r.upper, 1.0)
    if displacement < r.lower:
        return faded(r.lower_angle, r.lower_slope, r.lower_bend, r.lower - displacement, -1.0)
    angle, slope, bend, _ = closed_form(g, displacement)
    return angle, slope, bend


def faded(
    angle: float, slope: float, bend: float, distance: float, side: float
) -> tuple[float, float, float]:
    """Continuation at `distance` [m] beyond the end on `side`; see :func:`flap`."""
    fade = math.exp(-distance / DECAY)
    return (
        angle + side * slope * distance + bend * DECAY * (distance - DECAY * (1.0 - fade)),
        slope + side * bend * DECAY * (1.0 - fade),
        bend * fade,
    )
