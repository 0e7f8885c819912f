"""Right-hand side of the whole vehicle, made of the parts' own force and loss functions.

No laws, no held values, no communication points: charge, motion and energies of all parts in
one vector, each derivative from all others at the same instant.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

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

FIELDS = (
    "top_drive",
    "bottom_drive",
    "top_charge",
    "bottom_charge",
    "displacement",
    "velocity",
    "top_supplied",
    "top_loss",
    "bottom_supplied",
    "bottom_loss",
    "spring_loss",
    "force_work",
    "viscous_loss",
    "friction_loss",
    "stop_loss",
    "load_work",
    "u0",
    "u1",
    "u2",
    "u3",
)
"""Names of the entries of the state vector, in order."""

SCALES = (1e3, 1e3, 1e-6, 1e-6, 1e-3, 1e-1, *(1e-2,) * 10, *(1e-3,) * 4)
"""Sizes of the entries in use [SI], for absolute tolerances."""

IDEAL_RESISTANCE = 1.0e-3
NEWTON = 40


@dataclass(frozen=True)
class Composition:
    """Which parts there are, and their parameters; `None` for a part left out."""

    amplifier: amplifier.Params
    spring: spring.Params | None
    membrane: membrane.Params | None
    payload: payload.Params | None
    linkage: linkage.Params | None
    aero: aero.Params | None
    travel: Range | None


def voltages(c: Composition, y: Any) -> tuple[float, float]:
    """Voltages of both electrodes [V] from their charges and the displacement."""
    if c.membrane is not None:
        half = 0.5 * c.membrane.spacer
        top = film_voltage(c.membrane, half + float(y[4]), float(y[2]))
        return top, film_voltage(c.membrane, half - float(y[4]), float(y[3]))
    if c.spring is None:
        raise ValueError("the composition has no actuator")
    top = float(y[2] / spring.capacitance(c.spring, 1.0, y[4]))
    return top, float(y[3] / spring.capacitance(c.spring, -1.0, y[4]))


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
        voltage += change
        if abs(change) < 1e-12 * (1.0 + abs(voltage)):
            return voltage
    raise ValueError("no voltage belongs to the charge of a cone: near or past pull-in")


def actuator(c: Composition, y: Any, top: float, bottom: float) -> tuple[float, float, list[float]]:
    """Force on the mechanism [N], loss [W], and the rates of the relaxation branches [m/s]."""
    x, v = float(y[4]), float(y[5])
    if c.membrane is None:
        if c.spring is None:
            raise ValueError("the composition has no actuator")
        pull = spring.force_per_square(c.spring) * (top * top - bottom * bottom)
        force = spring.passive_force(c.spring, x, v) + pull
        return force, spring.damping(c.spring) * v * v, [0.0] * 4
    p = c.membrane
    half = 0.5 * p.spacer
    upper = membrane.cone(p, half + x, top * top)
    lower = membrane.cone(p, half - x, bottom * bottom)
    passive = 2.0 * membrane.cone(p, half, 0.0).stiffness
    eta = loss.scale(p.loss_factor, p.loss_frequency) * passive
    branches = [float(u) for u in y[16:20]]
    rates = [g * v - u / tau for g, tau, u in zip(loss.WEIGHTS, loss.TIMES, branches, strict=True)]
    lost = sum(
        u * u / (g * tau) for g, tau, u in zip(loss.WEIGHTS, loss.TIMES, branches, strict=True)
    )
    force = lower.force - upper.force - p.damping * v - eta * sum(branches)
    force += eta * loss.storage(p.storage_frequency) * x
    return force, eta * lost + p.damping * v * v, rates


def currents(c: Composition, y: Any, drives: tuple[float, float]) -> tuple[float, float]:
    """Electrode currents [A] behind the amplifier's voltages, within its limits."""
    p = c.amplifier
    resistance = max(p.resistance, IDEAL_RESISTANCE)
    flows = []
    for drive, voltage in zip(drives, voltages(c, y), strict=True):
        bound = amplifier.current_limit(p, voltage)
        flows.append(max(-bound, min(bound, (drive - voltage) / resistance)))
    return flows[0], flows[1]


def right_hand_side(
    c: Composition, u: amplifier.Input, inside: float
) -> Callable[[float, Any], list[float]]:
    """dy/dt over one smooth piece of the drive, of which `inside` is a time.

    A trial state outside the model gives NaN, on which the solver shortens its step.
    """
    p = c.amplifier
    lagging = p.bandwidth < UNLIMITED or p.slew_rate < UNLIMITED
    rate = 2.0 * math.pi * min(p.bandwidth, 1.0e9)

    def derivative(t: float, y: Any) -> list[float]:
        try:
            return inner(t, y)
        except (ValueError, OverflowError):
            return [math.nan] * len(FIELDS)

    def inner(t: float, y: Any) -> list[float]:
        commands = (
            amplifier.command(p, u, 1.0, t, inside),
            amplifier.command(p, u, -1.0, t, inside),
        )
        drives = commands
        slews = (0.0, 0.0)
        if lagging:
            drives = (float(y[0]), float(y[1]))
            slews = (
                max(-p.slew_rate, min(p.slew_rate, (commands[0] - drives[0]) * rate)),
                max(-p.slew_rate, min(p.slew_rate, (commands[1] - drives[1]) * rate)),
            )
        top, bottom = voltages(c, y)
        i_top, i_bottom = currents(c, y, drives)
        resistance = max(p.resistance, IDEAL_RESISTANCE)
        x, v = float(y[4]), float(y[5])
        force, lost, relaxing = actuator(c, y, top, bottom)
        motion = mechanics(c, x, v, force)
        return [
            slews[0],
            slews[1],
            i_top,
            i_bottom,
            v,
            motion.acceleration,
            top * i_top + resistance * i_top * i_top,
            resistance * i_top * i_top,
            bottom * i_bottom + resistance * i_bottom * i_bottom,
            resistance * i_bottom * i_bottom,
            lost,
            motion.force_power,
            motion.viscous_power,
            motion.friction_power,
            motion.stop_power,
            motion.load_power,
            *relaxing,
        ]

    return derivative


def mechanics(c: Composition, x: float, v: float, force: float) -> linkage.Flow:
    """Acceleration and powers of the mechanism, whichever there is, under a force [N]."""
    if c.payload is not None:
        return linkage.Flow(
            acceleration=force / c.payload.mass - c.payload.gravity,
            force_power=force * v,
            viscous_power=0.0,
            friction_power=0.0,
            stop_power=0.0,
            load_power=0.0,
        )
    if c.linkage is None or c.travel is None:
        raise ValueError("the composition has no mechanism")
    _, slope, bend = flap(linkage.geometry(c.linkage), c.travel, x)
    torque = 0.0
    air = 0.0
    if c.aero is not None:
        w = slope * v
        drag, _ = aero.drag_law(c.aero, w)
        torque = -drag * w * math.fabs(w)
        air, _ = aero.inertia_law(c.aero, w)
    return linkage.balance(c.linkage, x, v, slope, bend, force, torque, air)
