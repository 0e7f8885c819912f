"""Slider, double rocker and wings as one degree of freedom, driven through two law ports.

With x the slider's displacement, phi(x) the flap angle and w = phi' x' the flap rate

    m x'' + s |W| mu + W = F - c x' - s Fc - F_stop,
    W = A x'' + B,   A = (J + J_add) phi'^2,   B = (J + J_add) phi' phi'' x'^2 - T phi',

s = tanh(x'/v_s). W is what the wings ask of the slider; the joints' friction grows with it.
F is the law of the `force` port, T and J_add come through the `load` port, and the stops are
Hertzian contacts with damping in proportion to their force (Hunt & Crossley 1975).
Masses, inertias and friction are lumped and calibrated (README.md): the paper prints none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import elapsed, force_at, inertia_at, torque_at
from ..ports import ForceInput
from ..quantity import UNLIMITED, parameter, provided, received
from .kinematics import Geometry, Range, flap, usable_range

PRINTED = "printed: table 3; which link it is, inferred"
MOST_SUBSTEPS = 1.0e6


@dataclass(frozen=True)
class Params:
    """Lengths, lumped masses, friction and stops of the mechanism."""

    conrod: float = parameter(8.0e-3, "m", "Length of the conrod, L1", PRINTED, least=1.0e-6)
    crank: float = parameter(4.0e-3, "m", "Length of the crank, L2", PRINTED, least=1.0e-6)
    arm: float = parameter(8.5e-3, "m", "Length of the bell-crank arm, L3", PRINTED, least=1.0e-6)
    coupler: float = parameter(18.0e-3, "m", "Length of the coupler, L4", PRINTED, least=1.0e-6)
    rocker: float = parameter(5.0e-3, "m", "Length of the rocker, L5", PRINTED, least=1.0e-6)
    slider_mass: float = parameter(
        7.145e-3,
        "kg",
        "Mass of slider and links, lumped at the slider",
        "calibrated: figure 11, 34 Hz without wings",
        least=1.0e-9,
    )
    wing_inertia: float = parameter(
        0.0,
        "kg.m2",
        "Moment of inertia of both wings about the root, without added mass",
        "chosen: no wings",
        least=0.0,
        tunable=True,
    )
    damping: float = parameter(
        0.0,
        "N.s/m",
        "Viscous damping at the slider",
        "chosen: none, the loss is dry friction",
        least=0.0,
        tunable=True,
    )
    joint_friction: float = parameter(
        0.1476,
        "1",
        "Friction coefficient on the wing load, joints and slider guide together",
        "calibrated: figure 11, 83 degrees with frames",
        least=0.0,
        most=0.99,
        tunable=True,
    )
    coulomb_friction: float = parameter(
        0.24626,
        "N",
        "Friction force independent of load",
        "calibrated: figure 11, 96 degrees without wings; depends on the actuator",
        least=0.0,
        tunable=True,
    )
    friction_velocity: float = parameter(
        5.0e-3, "m/s", "Velocity over which friction changes sign", "assumed", least=1.0e-9
    )
    stop_travel: float = parameter(
        2.0e-3,
        "m",
        "Travel from the neutral pose to either stop",
        "inferred: above the 1.75 mm of 96 degrees, below the singularity at 2.25 mm",
        least=1.0e-6,
    )
    stop_stiffness: float = parameter(
        1.0e8,
        "N/m",
        "Contact stiffness k in F = k d sqrt(d/(1 m)) (1 + D d'), d the depth",
        "assumed: Hertz contact, 1 to 2 mm radius, nylon on acrylic",
        least=0.0,
    )
    stop_damping: float = parameter(
        2.5, "s/m", "Contact damping D", "assumed: restitution of 0.5 at 0.3 m/s", least=0.0
    )
    start_displacement: float = parameter(
        0.0, "m", "Slider displacement at start", "chosen: neutral pose"
    )
    start_velocity: float = parameter(0.0, "m/s", "Slider velocity at start", "chosen: at rest")
    resolution: float = parameter(
        0.1,
        "1",
        "Largest substep times the fastest rate of the mechanism",
        "chosen: integrator error well below the coupling's",
        least=1.0e-4,
        most=0.5,
    )


@dataclass(frozen=True)
class Input(ForceInput):
    """Force law of the actuator and load law of the wings; plain numbers will do."""

    load_torque: float = received(
        0.0, "N.m", "Torque on both wings at the reference rate", port="load"
    )
    load_added_inertia: float = received(
        0.0, "kg.m2", "Inertia of the air moved by both wings", port="load"
    )
    load_damping: float = received(0.0, "N.m.s", "-dT/dw", port="load", order=1)
    load_quadratic_drag: float = received(
        0.0, "N.m.s2", "c in the drag torque -c w |w|", port="load", order=1
    )
    load_quadratic_drag_slope: float = received(
        0.0, "N.m.s3", "dc/dw about the reference rate", port="load", order=2
    )
    load_added_inertia_slope: float = received(
        0.0, "kg.m2.s", "d(added inertia)/dw about the reference rate", port="load", order=2
    )
    load_reference_rate: float = received(
        0.0, "rad/s", "Flap rate at which the law holds", port="load", order=1
    )


@dataclass(frozen=True)
class State:
    """Motion [m, m/s] with the pose that goes with it, energies so far [J], and the ends of
    the linkage's range."""

    displacement: float
    velocity: float
    angle: float
    slope: float
    bend: float
    force_work: float
    viscous_loss: float
    friction_loss: float
    stop_loss: float
    load_work: float
    lower: float
    lower_angle: float
    lower_slope: float
    lower_bend: float
    upper: float
    upper_angle: float
    upper_slope: float
    upper_bend: float


@dataclass(frozen=True)
class Flow:
    """Time derivatives: acceleration [m/s2] and the powers of each exchange [W]."""

    acceleration: float
    force_power: float
    viscous_power: float
    friction_power: float
    stop_power: float
    load_power: float


@dataclass(frozen=True)
class Output:
    """Motion, contact and energies."""

    motion_displacement: float = provided("m", "Slider displacement", port="motion")
    motion_velocity: float = provided("m/s", "Slider velocity", port="motion")
    motion_flap_angle: float = provided("rad", "Flap angle", port="motion")
    motion_flap_rate: float = provided("rad/s", "Flap rate", port="motion")
    motion_reference_time: float = provided(
        "s", "Time at which the motion holds", port="motion", order=1
    )
    displacement: float = provided("m", "Slider displacement", least=-1.0, most=1.0)
    velocity: float = provided("m/s", "Slider velocity", least=-1.0e4, most=1.0e4)
    flap_angle: float = provided("rad", "Flap angle")
    flap_rate: float = provided("rad/s", "Flap rate")
    transmission: float = provided("rad/m", "d(flap angle)/d(displacement)")
    stop_force: float = provided("N", "Force of the stops on the slider")
    kinetic_energy: float = provided("J", "Kinetic energy of slider and wings")
    stop_energy: float = provided("J", "Elastic energy in the stops")
    force_work: float = provided("J", "Work received through the force port")
    viscous_loss: float = provided("J", "Loss in the viscous damping")
    friction_loss: float = provided("J", "Loss in the friction")
    stop_loss: float = provided("J", "Loss in the stops")
    load_work: float = provided("J", "Work delivered through the load port")


def geometry(p: Params) -> Geometry:
    """The five lengths as the kinematics take them."""
    return Geometry(conrod=p.conrod, crank=p.crank, arm=p.arm, coupler=p.coupler, rocker=p.rocker)


def travel(x: State) -> Range:
    """The usable range that the state carries."""
    return Range(
        lower=x.lower,
        lower_angle=x.lower_angle,
        lower_slope=x.lower_slope,
        lower_bend=x.lower_bend,
        upper=x.upper,
        upper_angle=x.upper_angle,
        upper_slope=x.upper_slope,
        upper_bend=x.upper_bend,
    )


def initial(p: Params, u: Input, t: float) -> State:
    """State at start; `ValueError` where the stops do not keep clear of the singularities."""
    r = usable_range(geometry(p))
    if p.stop_travel >= r.upper or p.stop_travel >= -r.lower:
        raise ValueError("stop_travel reaches the linkage's singularity: lower it")
    if p.start_displacement > r.upper or p.start_displacement < r.lower:
        raise ValueError("start_displacement is outside the linkage's usable range")
    angle, slope, bend = flap(geometry(p), r, p.start_displacement)
    return State(
        displacement=p.start_displacement,
        velocity=p.start_velocity,
        angle=angle,
        slope=slope,
        bend=bend,
        force_work=0.0,
        viscous_loss=0.0,
        friction_loss=0.0,
        stop_loss=0.0,
        load_work=0.0,
        lower=r.lower,
        lower_angle=r.lower_angle,
        lower_slope=r.lower_slope,
        lower_bend=r.lower_bend,
        upper=r.upper,
        upper_angle=r.upper_angle,
        upper_slope=r.upper_slope,
        upper_bend=r.upper_bend,
    )


def stop_elastic(p: Params, displacement: float) -> float:
    """Elastic force of the stops on the slider [N], against the displacement."""
    depth = math.fabs(displacement) - p.stop_travel
    if depth <= 0.0:
        return 0.0
    return -math.copysign(p.stop_stiffness * depth * math.sqrt(depth), displacement)


def stop_force(p: Params, displacement: float, velocity: float) -> float:
    """Force of the stops on the slider [N]; a contact pushes, it never pulls."""
    elastic = stop_elastic(p, displacement)
    if elastic == 0.0:
        return 0.0
    closing = math.copysign(velocity, velocity * displacement)
    return elastic * max(0.0, 1.0 + p.stop_damping * closing)


def stop_energy(p: Params, displacement: float) -> float:
    """Elastic energy in the stops [J]."""
    depth = max(0.0, math.fabs(displacement) - p.stop_travel)
    return 0.4 * p.stop_stiffness * depth * depth * math.sqrt(depth)


def slider_acceleration(
    mass: float,
    applied: float,
    coulomb: float,
    joint: float,
    wing: float,
    bias: float,
) -> float:
    """x'' [m/s2] of m x'' = applied - coulomb - joint |W| - W with W = wing x'' + bias.

    `coulomb` and `joint` carry the sign of the motion. Since |joint| < 1 the left side
    minus the right grows with W, so the sign of W is that of m bias + wing (applied - coulomb).
    """
    net = applied - coulomb
    side = 1.0 + joint
    if mass * bias + wing * net < 0.0:
        side = 1.0 - joint
    return (net - side * bias) / (mass + side * wing)


def flow(
    p: Params,
    u: Input,
    displacement: float,
    velocity: float,
    slope: float,
    bend: float,
    s: float,
) -> Flow:
    """Acceleration and powers at a state, `s` [s] after the force law's reference time."""
    rate = slope * velocity
    force = force_at(
        u.force_value,
        u.force_stiffness,
        u.force_damping,
        u.force_rate,
        u.force_curvature,
        displacement - u.force_reference_displacement,
        velocity - u.force_reference_velocity,
        s,
    )
    torque = torque_at(
        u.load_torque,
        u.load_damping,
        u.load_quadratic_drag,
        u.load_quadratic_drag_slope,
        u.load_reference_rate,
        rate,
    )
    air = inertia_at(u.load_added_inertia, u.load_added_inertia_slope, u.load_reference_rate, rate)
    return balance(p, displacement, velocity, slope, bend, force, torque, air)


def balance(
    p: Params,
    displacement: float,
    velocity: float,
    slope: float,
    bend: float,
    force: float,
    torque: float,
    air: float,
) -> Flow:
    """Equation of motion at one pose under a force [N], torque [N m] and added inertia."""
    inertia = p.wing_inertia + air
    wing = inertia * slope * slope
    coriolis = inertia * slope * bend * velocity * velocity
    direction = math.tanh(velocity / p.friction_velocity)
    viscous = p.damping * velocity
    stop = stop_force(p, displacement, velocity)
    acceleration = slider_acceleration(
        p.slider_mass,
        force - viscous + stop,
        direction * p.coulomb_friction,
        direction * p.joint_friction,
        wing,
        coriolis - torque * slope,
    )
    flap_acceleration = slope * acceleration + bend * velocity * velocity
    load = torque - air * flap_acceleration
    friction = force - viscous + stop - p.slider_mass * acceleration
    friction = friction - (p.wing_inertia * flap_acceleration - load) * slope
    return Flow(
        acceleration=acceleration,
        force_power=force * velocity,
        viscous_power=viscous * velocity,
        friction_power=friction * velocity,
        stop_power=(stop_elastic(p, displacement) - stop) * velocity,
        load_power=-load * slope * velocity,
    )


def largest_substep(
    p: Params, u: Input, displacement: float, velocity: float, slope: float
) -> float:
    """Substep [s] that resolves stiffness, damping, friction and, near a stop, the contact."""
    inertia = p.wing_inertia + max(0.0, u.load_added_inertia)
    mass = p.slider_mass + inertia * slope * slope
    drag = 2.0 * math.fabs(u.load_quadratic_drag * slope * velocity) + math.fabs(u.load_damping)
    drag = drag * slope * slope
    resisting = p.damping + math.fabs(u.force_damping) + drag
    grip = p.coulomb_friction + p.joint_friction * math.fabs(u.force_value)
    resisting = resisting + grip / p.friction_velocity
    rate = math.sqrt(math.fabs(u.force_stiffness) / mass)
    limit = p.resolution / max(rate, 0.2 * resisting / mass, 1.0 / UNLIMITED)
    if p.stop_stiffness == 0.0:
        return limit
    reach = math.fabs(displacement) + 2.0 * math.fabs(velocity) * limit
    if reach <= p.stop_travel:
        return limit
    energy = 0.5 * mass * velocity * velocity + stop_energy(p, displacement)
    depth = math.exp(0.4 * math.log(max(2.5 * energy / p.stop_stiffness, 1.0e-30)))
    contact = math.sqrt(1.5 * p.stop_stiffness * math.sqrt(depth) / mass)
    return min(limit, p.resolution / contact)


def reversal_substep(p: Params, velocity: float, acceleration: float, limit: float) -> float:
    """Substep [s] that resolves the change of sign of the friction, if it may come within `limit`.

    Over it the velocity changes by no more than 5 `resolution` of the width of that change.
    """
    if p.coulomb_friction + p.joint_friction <= 0.0:
        return limit
    pull = math.fabs(acceleration)
    if math.fabs(velocity) > 3.0 * p.friction_velocity + pull * limit:
        return limit
    return min(limit, 5.0 * p.resolution * p.friction_velocity / max(pull, 1.0 / UNLIMITED))


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Motion after `h` [s] by the classical Runge-Kutta method with substeps.

    Energies are integrated with the same stages as the motion.
    """
    g = geometry(p)
    r = travel(x)
    time = 0.0
    count = 0.0
    start = elapsed(t, u.force_reference_time)
    q = x.displacement
    v = x.velocity
    angle = x.angle
    slope = x.slope
    bend = x.bend
    force_work = x.force_work
    viscous_loss = x.viscous_loss
    friction_loss = x.friction_loss
    stop_loss = x.stop_loss
    load_work = x.load_work
    while time < h:
        s = start + time
        k1 = flow(p, u, q, v, slope, bend, s)
        limit = largest_substep(p, u, q, v, slope)
        limit = reversal_substep(p, v, k1.acceleration, limit)
        left = max(1.0, float(math.ceil((h - time) / limit * (1.0 - 1.0e-12))))
        span = (h - time) / left
        count = count + 1.0
        if left + count > MOST_SUBSTEPS:
            raise ValueError("the mechanism is too stiff for this step: more than 1e6 substeps")
        half = 0.5 * span
        q2 = q + half * v
        v2 = v + half * k1.acceleration
        _, slope, bend = flap(g, r, q2)
        k2 = flow(p, u, q2, v2, slope, bend, s + half)
        q3 = q + half * v2
        v3 = v + half * k2.acceleration
        _, slope, bend = flap(g, r, q3)
        k3 = flow(p, u, q3, v3, slope, bend, s + half)
        q4 = q + span * v3
        v4 = v + span * k3.acceleration
        _, slope, bend = flap(g, r, q4)
        k4 = flow(p, u, q4, v4, slope, bend, s + span)
        sixth = span / 6.0
        q = q + sixth * (v + 2.0 * (v2 + v3) + v4)
        v = v + sixth * (
            k1.acceleration + 2.0 * (k2.acceleration + k3.acceleration) + k4.acceleration
        )
        force_work = force_work + sixth * (
            k1.force_power + 2.0 * (k2.force_power + k3.force_power) + k4.force_power
        )
        viscous_loss = viscous_loss + sixth * (
            k1.viscous_power + 2.0 * (k2.viscous_power + k3.viscous_power) + k4.viscous_power
        )
        friction_loss = friction_loss + sixth * (
            k1.friction_power + 2.0 * (k2.friction_power + k3.friction_power) + k4.friction_power
        )
        stop_loss = stop_loss + sixth * (
            k1.stop_power + 2.0 * (k2.stop_power + k3.stop_power) + k4.stop_power
        )
        load_work = load_work + sixth * (
            k1.load_power + 2.0 * (k2.load_power + k3.load_power) + k4.load_power
        )
        angle, slope, bend = flap(g, r, q)
        time = time + span
        if left <= 1.0:
            time = h
    return State(
        displacement=q,
        velocity=v,
        angle=angle,
        slope=slope,
        bend=bend,
        force_work=force_work,
        viscous_loss=viscous_loss,
        friction_loss=friction_loss,
        stop_loss=stop_loss,
        load_work=load_work,
        lower=r.lower,
        lower_angle=r.lower_angle,
        lower_slope=r.lower_slope,
        lower_bend=r.lower_bend,
        upper=r.upper,
        upper_angle=r.upper_angle,
        upper_slope=r.upper_slope,
        upper_bend=r.upper_bend,
    )


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    rate = x.slope * x.velocity
    return Output(
        motion_displacement=x.displacement,
        motion_velocity=x.velocity,
        motion_flap_angle=x.angle,
        motion_flap_rate=rate,
        motion_reference_time=t,
        displacement=x.displacement,
        velocity=x.velocity,
        flap_angle=x.angle,
        flap_rate=rate,
        transmission=x.slope,
        stop_force=stop_force(p, x.displacement, x.velocity),
        kinetic_energy=0.5 * p.slider_mass * x.velocity * x.velocity
        + 0.5 * p.wing_inertia * rate * rate,
        stop_energy=stop_energy(p, x.displacement),
        force_work=x.force_work,
        viscous_loss=x.viscous_loss,
        friction_loss=x.friction_loss,
        stop_loss=x.stop_loss,
        load_work=x.load_work,
    )
