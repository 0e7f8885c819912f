"""Quasi-steady load of two flapping wings that feather elastically.

Per wing, with w the flap rate, R the wing length, c the mean chord and a the angle of attack,

    drag torque   -1/2 rho C_D(a) c R^4 r3^3 w |w|,
    lift           1/2 rho C_L(a) c R^3 r2^2 w^2,
    added inertia  rho (pi/4) c^2 R^3 k sin^2(a),

C_L = C_T sin 2a and C_D = C_D0 cos^2 a + C_D90 sin^2 a (Berman & Wang 2007, hawkmoth). The
wing pitches by theta = theta_max u / sqrt(u^2 + k_f^2) with u = (w / w_ref)^2, so a = 90 deg
- theta: broadside at the reversals, feathered in mid-stroke. Without feathering there is no
lift, so an assumption of this kind cannot be avoided; the paper states none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import elapsed
from ..quantity import NO_REFERENCE, parameter, provided, received

HAWKMOTH = "assumed: Berman & Wang 2007, hawkmoth; quoted, not checked against the source"
STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Params:
    """Wing planform, air, coefficients and feathering."""

    wing_length: float = parameter(0.04, "m", "Wing length R", "printed: table 3", least=1.0e-4)
    aspect_ratio: float = parameter(
        6.0, "1", "Aspect ratio 2R/c of the pair", "printed: table 3", least=0.1
    )
    second_moment_radius: float = parameter(
        0.56,
        "1",
        "Radius of the second moment of area over R",
        "inferred: the 0.387 of equation 6 with air of 1.2 to 1.225 kg/m3",
        least=0.0,
        most=1.0,
    )
    third_moment_radius: float = parameter(
        0.602,
        "1",
        "Radius of the third moment of area over R",
        "assumed: Ellington's relation to the second",
        least=0.0,
        most=1.0,
    )
    air_density: float = parameter(
        1.2, "kg/m3", "Density of the air", "assumed", least=0.0, tunable=True
    )
    membrane_share: float = parameter(
        1.0,
        "1",
        "Share of the wing's area that has a membrane; 0 is a bare frame",
        "chosen: whole",
        least=0.0,
        most=1.0,
        tunable=True,
    )
    lift_coefficient: float = parameter(1.678, "1", "C_T in C_L = C_T sin 2a", HAWKMOTH)
    drag_edgewise: float = parameter(0.07, "1", "C_D at a = 0", HAWKMOTH, least=0.0)
    drag_broadside: float = parameter(3.06, "1", "C_D at a = 90 degrees", HAWKMOTH, least=0.0)
    feathering_angle: float = parameter(
        0.25 * math.pi, "rad", "Largest pitch theta_max", "assumed: 45 degrees", least=0.0, most=1.5
    )
    feathering_softness: float = parameter(
        0.15, "1", "k_f: how late the pitch saturates", "assumed", least=1.0e-6
    )
    feathering_rate: float = parameter(
        62.0, "rad/s", "Flap rate w_ref of full pitch", "assumed: peak rate at 18 Hz", least=1.0e-6
    )
    added_mass_factor: float = parameter(
        0.3, "1", "k: spanwise integral of the added mass", "assumed", least=0.0
    )
    hover_lift_coefficient: float = parameter(
        2.056,
        "1",
        "C_L of equation 6",
        "inferred: the 133 mg at 63 degrees and 18 Hz; the paper states 2 to 3",
    )


@dataclass(frozen=True)
class Input:
    """Motion of the wing."""

    motion_flap_angle: float = received(0.0, "rad", "Flap angle", port="motion")
    motion_flap_rate: float = received(0.0, "rad/s", "Flap rate", port="motion")
    motion_reference_time: float = received(
        NO_REFERENCE, "s", "Time at which the motion holds", port="motion", order=1
    )


@dataclass(frozen=True)
class State:
    """Last motion sample [s, rad, rad/s] and what was seen of the stroke so far."""

    sample_time: float
    sample_angle: float
    sample_rate: float
    highest: float
    lowest: float
    reversal_time: float
    period: float


_MOTION = ("motion",)
_RATE = ("motion.flap_rate",)


@dataclass(frozen=True)
class Output:
    """Load law, lift and power of both wings together."""

    load_torque: float = provided(
        "N.m", "Drag torque at the reference rate", port="load", depends=_RATE
    )
    load_added_inertia: float = provided(
        "kg.m2", "Inertia of the air moved", port="load", depends=_RATE
    )
    load_quadratic_drag: float = provided(
        "N.m.s2", "c in the drag torque -c w |w|", port="load", order=1, depends=_RATE
    )
    load_quadratic_drag_slope: float = provided(
        "N.m.s3", "dc/dw at the reference rate", port="load", order=2, depends=_RATE
    )
    load_added_inertia_slope: float = provided(
        "kg.m2.s", "d(added inertia)/dw at the reference rate", port="load", order=2, depends=_RATE
    )
    load_reference_rate: float = provided(
        "rad/s", "Flap rate at which the law holds", port="load", order=1, depends=_RATE
    )
    lift: float = provided("N", "Lift of both wings", depends=_RATE)
    angle_of_attack: float = provided("rad", "Angle of attack", depends=_RATE)
    drag_power: float = provided("W", "Power lost to drag, both wings", depends=_RATE)
    stroke: float = provided("rad", "Peak-to-peak stroke last seen", depends=_MOTION)
    frequency: float = provided("Hz", "Flapping frequency last seen", depends=_MOTION)
    hover_mass: float = provided("kg", "Mass supported in hovering by equation 6", depends=_MOTION)


def chord(p: Params) -> float:
    """Mean chord 2R/AR [m]."""
    return 2.0 * p.wing_length / p.aspect_ratio


def drag_area(p: Params) -> float:
    """1/2 rho c R^4 r3^3 of both wings [N m s2]."""
    r2 = p.wing_length * p.wing_length
    r3 = p.third_moment_radius
    return p.membrane_share * p.air_density * chord(p) * r2 * r2 * r3 * r3 * r3


def lift_area(p: Params) -> float:
    """1/2 rho c R^3 r2^2 of both wings [N s2]."""
    r = p.wing_length
    r2 = p.second_moment_radius
    return p.membrane_share * p.air_density * chord(p) * r * r * r * r2 * r2


def broadside_inertia(p: Params) -> float:
    """Added inertia of both wings at a = 90 degrees [kg m2]."""
    r = p.wing_length
    c = chord(p)
    swept = 0.5 * math.pi * p.air_density * c * c * r * r * r
    return p.membrane_share * swept * p.added_mass_factor


def pitch(p: Params, rate: float) -> tuple[float, float]:
    """Feathering angle theta [rad] and d(theta)/dw [s] at a flap rate [rad/s]."""
    u = (rate / p.feathering_rate) * (rate / p.feathering_rate)
    root = u * u + p.feathering_softness * p.feathering_softness
    size = math.sqrt(root)
    du = 2.0 * rate / (p.feathering_rate * p.feathering_rate)
    soft = p.feathering_softness * p.feathering_softness
    return p.feathering_angle * u / size, p.feathering_angle * du * soft / (root * size)


def drag_law(p: Params, rate: float) -> tuple[float, float]:
    """Quadratic drag c [N m s2] of -c w |w| and dc/dw [N m s3], both wings."""
    theta, slope = pitch(p, rate)
    s = math.sin(theta)
    c = math.cos(theta)
    area = drag_area(p)
    value = area * (p.drag_edgewise * s * s + p.drag_broadside * c * c)
    return value, area * 2.0 * s * c * (p.drag_edgewise - p.drag_broadside) * slope


def inertia_law(p: Params, rate: float) -> tuple[float, float]:
    """Added inertia [kg m2] and its derivative by the flap rate [kg m2 s], both wings."""
    theta, slope = pitch(p, rate)
    c = math.cos(theta)
    full = broadside_inertia(p)
    return full * c * c, -2.0 * full * c * math.sin(theta) * slope


def lift(p: Params, rate: float) -> float:
    """Lift of both wings [N]."""
    theta, _ = pitch(p, rate)
    return lift_area(p) * p.lift_coefficient * math.sin(2.0 * theta) * rate * rate


def hover_mass(p: Params, stroke: float, frequency: float) -> float:
    """Equation 6 [kg]: 0.387 Phi^2 n^2 R^4 C_L / AR, stroke in rad peak to peak."""
    r2 = p.wing_length * p.wing_length
    swept = stroke * frequency * r2
    return 0.387 * swept * swept * p.hover_lift_coefficient / p.aspect_ratio


def initial(p: Params, u: Input, t: float) -> State:
    return State(
        sample_time=t,
        sample_angle=u.motion_flap_angle,
        sample_rate=u.motion_flap_rate,
        highest=0.0,
        lowest=0.0,
        reversal_time=t,
        period=0.0,
    )


def seen(p: Params, x: State, u: Input, t: float) -> State:
    """State with the motion sample on the input taken in.

    A reversal between two samples is placed where the flap rate, taken as linear, is zero;
    the angle there is that of the cubic through both samples to second order.
    """
    time = t - elapsed(t, u.motion_reference_time)
    highest = x.highest
    lowest = x.lowest
    reversal_time = x.reversal_time
    period = x.period
    turned = x.sample_rate * u.motion_flap_rate < 0.0 and time > x.sample_time
    if turned:
        part = x.sample_rate / (x.sample_rate - u.motion_flap_rate)
        span = (time - x.sample_time) * part
        peak = x.sample_angle + 0.5 * x.sample_rate * span
        if x.sample_rate > 0.0:
            highest = peak
            if x.reversal_time > 0.0:
                period = x.sample_time + span - x.reversal_time
            reversal_time = x.sample_time + span
        else:
            lowest = peak
    return State(
        sample_time=time,
        sample_angle=u.motion_flap_angle,
        sample_rate=u.motion_flap_rate,
        highest=highest,
        lowest=lowest,
        reversal_time=reversal_time,
        period=period,
    )


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Take in the motion sample on the input; the load itself has no memory."""
    return seen(p, x, u, t)


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    rate = u.motion_flap_rate
    drag, drag_slope = drag_law(p, rate)
    inertia, inertia_slope = inertia_law(p, rate)
    torque = -drag * rate * math.fabs(rate)
    theta, _ = pitch(p, rate)
    now = seen(p, x, u, t)
    stroke = now.highest - now.lowest
    frequency = 0.0
    if now.period > 0.0:
        frequency = 1.0 / now.period
    return Output(
        load_torque=torque,
        load_added_inertia=inertia,
        load_quadratic_drag=drag,
        load_quadratic_drag_slope=drag_slope,
        load_added_inertia_slope=inertia_slope,
        load_reference_rate=rate,
        lift=lift(p, rate),
        angle_of_attack=0.5 * math.pi - theta,
        drag_power=-torque * rate,
        stroke=stroke,
        frequency=frequency,
        hover_mass=hover_mass(p, stroke, frequency),
    )
