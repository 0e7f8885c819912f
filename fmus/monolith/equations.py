"""Right-hand side of the whole vehicle, made of the parts' own force and loss functions.

No laws, no held values, no communication points: charge, motion and energies of all parts in
one vector, each derivative from all others at the same instant. Written in the subset of the
parts' physics, so that the same text compiles (`fmus/native/reference.py`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from ..aero import physics as aero
from ..amplifier import physics as amplifier
from ..linkage import physics as linkage
from ..linkage.kinematics import Range, flap
from ..membrane import loss
from ..membrane import physics as membrane
from ..membrane.tables import LOADING
from ..payload import physics as payload
from ..quantity import UNLIMITED
from ..spring import physics as spring


@dataclass(frozen=True)
class Vector:
    """The state vector, or its time derivative, entry by entry."""

    top_drive: float
    bottom_drive: float
    top_charge: float
    bottom_charge: float
    displacement: float
    velocity: float
    top_supplied: float
    top_loss: float
    bottom_supplied: float
    bottom_loss: float
    spring_loss: float
    force_work: float
    viscous_loss: float
    friction_loss: float
    stop_loss: float
    load_work: float
    u0: float
    u1: float
    u2: float
    u3: float


FIELDS = tuple(field.name for field in fields(Vector))
"""Names of the entries of the state vector, in order."""

SCALES = (1e3, 1e3, 1e-6, 1e-6, 1e-3, 1e-1, *(1e-2,) * 10, *(1e-3,) * 4)
"""Sizes of the entries in use [SI], for absolute tolerances."""

IDEAL_RESISTANCE = 1.0e-3
NEWTON = 40


@dataclass(frozen=True)
class Composition:
    """Parameters of all parts and the linkage's range; which of them count.

    The actuator is the membrane where `filmed` is 1, else the spring; the mechanism the
    linkage where `linked` is 1, else the payload; there is air where `winged` is 1.
    """

    amplifier: amplifier.Params
    spring: spring.Params
    membrane: membrane.Params
    payload: payload.Params
    linkage: linkage.Params
    aero: aero.Params
    travel: Range
    filmed: float
    linked: float
    winged: float


@dataclass(frozen=True)
class Pull:
    """What the actuator does: force [N], loss [W] and the rates of its branches [m/s]."""

    force: float
    lost: float
    u0: float
    u1: float
    u2: float
    u3: float


def voltages(c: Composition, y: Vector) -> tuple[float, float]:
    """Voltages of both electrodes [V] from their charges and the displacement."""
    if c.filmed == 1.0:
        half = 0.5 * c.membrane.spacer
        top = film_voltage(c.membrane, half + y.displacement, y.top_charge)
        return top, film_voltage(c.membrane, half - y.displacement, y.bottom_charge)
    top = y.top_charge / spring.capacitance(c.spring, 1.0, y.displacement)
    return top, y.bottom_charge / spring.capacitance(c.spring, -1.0, y.displacement)


def film_voltage(p: membrane.Params, height: float, charge: float) -> float:
    """Voltage [V] at which a cone carries a charge [C]: Newton's method on Q(V) = -2 V dPi/dE,
    kept within the film's table."""
    most = math.sqrt(LOADING[int(p.film) - 1] / membrane.loading(p)) * (1.0 - 1e-9)
    voltage = -0.5 * charge / membrane.cone(p, height, 0.0).by_square
    for _ in range(NEWTON):
        voltage = max(-most, min(most, voltage))
        here = membrane.cone(p, height, voltage * voltage)
        slope = -2.0 * here.by_square - 4.0 * voltage * voltage * here.by_square_twice
        change = (charge + 2.0 * voltage * here.by_square) / slope
        voltage = voltage + change
        if math.fabs(change) < 1e-12 * (1.0 + math.fabs(voltage)):
            return voltage
    raise ValueError("no voltage belongs to the charge of a cone: near or past pull-in")


def actuator(c: Composition, y: Vector, top: float, bottom: float) -> Pull:
    """Force on the mechanism, loss, and the rates of the relaxation branches."""
    x = y.displacement
    v = y.velocity
    if c.filmed != 1.0:
        pull = spring.force_per_square(c.spring) * (top * top - bottom * bottom)
        return Pull(
            force=spring.passive_force(c.spring, x, v) + pull,
            lost=spring.damping(c.spring) * v * v,
            u0=0.0,
            u1=0.0,
            u2=0.0,
            u3=0.0,
        )
    p = c.membrane
    half = 0.5 * p.spacer
    upper = membrane.cone(p, half + x, top * top)
    lower = membrane.cone(p, half - x, bottom * bottom)
    passive = 2.0 * membrane.cone(p, half, 0.0).stiffness
    eta = loss.scale(p.loss_factor, p.loss_frequency) * passive
    lost = branch_loss(0, y.u0) + branch_loss(1, y.u1) + branch_loss(2, y.u2)
    lost = lost + branch_loss(3, y.u3)
    force = lower.force - upper.force - p.damping * v - eta * (y.u0 + y.u1 + y.u2 + y.u3)
    force = force + eta * loss.storage(p.storage_frequency) * x
    return Pull(
        force=force,
        lost=eta * lost + p.damping * v * v,
        u0=branch_rate(0, y.u0, v),
        u1=branch_rate(1, y.u1, v),
        u2=branch_rate(2, y.u2, v),
        u3=branch_rate(3, y.u3, v),
    )


def branch_rate(i: int, u: float, v: float) -> float:
    """Rate [m/s] of a relaxation branch."""
    return loss.WEIGHTS[i] * v - u / loss.TIMES[i]


def branch_loss(i: int, u: float) -> float:
    """Loss [W] of a relaxation branch over eta K."""
    return u * u / (loss.WEIGHTS[i] * loss.TIMES[i])


def current(p: amplifier.Params, drive: float, voltage: float) -> float:
    """Electrode current [A] behind the amplifier's voltage, within its limits."""
    resistance = max(p.resistance, IDEAL_RESISTANCE)
    bound = amplifier.current_limit(p, voltage)
    return max(-bound, min(bound, (drive - voltage) / resistance))


def slew(p: amplifier.Params, command: float, drive: float) -> float:
    """Rate [V/s] of an amplifier with a bandwidth or a slew rate."""
    rate = 2.0 * math.pi * min(p.bandwidth, 1.0e9)
    return max(-p.slew_rate, min(p.slew_rate, (command - drive) * rate))


def rates(c: Composition, u: amplifier.Input, inside: float, t: float, y: Vector) -> Vector:
    """dy/dt over one smooth piece of the drive, of which `inside` is a time."""
    p = c.amplifier
    top_drive = amplifier.command(p, u, 1.0, t, inside)
    bottom_drive = amplifier.command(p, u, -1.0, t, inside)
    top_slew = 0.0
    bottom_slew = 0.0
    if p.bandwidth < UNLIMITED or p.slew_rate < UNLIMITED:
        top_slew = slew(p, top_drive, y.top_drive)
        bottom_slew = slew(p, bottom_drive, y.bottom_drive)
        top_drive = y.top_drive
        bottom_drive = y.bottom_drive
    top, bottom = voltages(c, y)
    i_top = current(p, top_drive, top)
    i_bottom = current(p, bottom_drive, bottom)
    resistance = max(p.resistance, IDEAL_RESISTANCE)
    pull = actuator(c, y, top, bottom)
    motion = mechanics(c, y.displacement, y.velocity, pull.force)
    return Vector(
        top_drive=top_slew,
        bottom_drive=bottom_slew,
        top_charge=i_top,
        bottom_charge=i_bottom,
        displacement=y.velocity,
        velocity=motion.acceleration,
        top_supplied=top * i_top + resistance * i_top * i_top,
        top_loss=resistance * i_top * i_top,
        bottom_supplied=bottom * i_bottom + resistance * i_bottom * i_bottom,
        bottom_loss=resistance * i_bottom * i_bottom,
        spring_loss=pull.lost,
        force_work=motion.force_power,
        viscous_loss=motion.viscous_power,
        friction_loss=motion.friction_power,
        stop_loss=motion.stop_power,
        load_work=motion.load_power,
        u0=pull.u0,
        u1=pull.u1,
        u2=pull.u2,
        u3=pull.u3,
    )


def mechanics(c: Composition, x: float, v: float, force: float) -> linkage.Flow:
    """Acceleration and powers of the mechanism, whichever there is, under a force [N]."""
    if c.linked != 1.0:
        return linkage.Flow(
            acceleration=force / payload.moving(c.payload) - c.payload.gravity,
            force_power=force * v,
            viscous_power=0.0,
            friction_power=0.0,
            stop_power=0.0,
            load_power=0.0,
        )
    _, slope, bend = flap(linkage.geometry(c.linkage), c.travel, x)
    torque = 0.0
    air = 0.0
    if c.winged == 1.0:
        w = slope * v
        drag, _ = aero.drag_law(c.aero, w)
        torque = -drag * w * math.fabs(w)
        air, _ = aero.inertia_law(c.aero, w)
    return linkage.balance(c.linkage, x, v, slope, bend, force, torque, air)
