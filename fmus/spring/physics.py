"""Double-cone actuator as a linear spring with an electrostatic force from one co-energy.

The paper's section "Double Cone DEA Resonance Characterization" replaces the membranes by a
spring K. The electrical side is completed here so that energy closes: with the co-energy
C_top(x) V_top^2/2 + C_bottom(x) V_bottom^2/2 and C = C0 +- 2 a x,

    F = -K x - c v + a V_top^2 - a V_bottom^2,    Q = C(x) V,    a = F0 / V0^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import acceleration_between, elapsed, mean_square
from ..ports import ActuatorInput
from ..quantity import parameter, provided


@dataclass(frozen=True)
class Params:
    """Stiffness, loss and electrostatics of the double cone."""

    stiffness: float = parameter(
        331.0,
        "N/m",
        "Stiffness of the double cone",
        "inferred: 4 g at 45.8 Hz, table 2, eight layers",
        least=0.0,
    )
    damping: float = parameter(
        0.167,
        "N.s/m",
        "Viscous damping of the actuator",
        "inferred: table 2, 209 mW with 4 g read as the mean of |M x'' x'|",
        least=0.0,
    )
    loss_factor: float = parameter(
        0.0,
        "1",
        "Loss factor, acting as the damping eta K/(2 pi f) at the loss frequency",
        "chosen: none beside the viscous damping",
        least=0.0,
    )
    loss_frequency: float = parameter(
        50.0,
        "Hz",
        "Frequency at which the loss factor holds",
        "chosen: near the bench resonance",
        least=1.0e-6,
    )
    blocked_force: float = parameter(
        0.098,
        "N",
        "Force of one cone at the rated voltage",
        "inferred: Maxwell stress of the conical membrane, uncertain by 0.7 to 1.3",
    )
    rated_voltage: float = parameter(
        1920.0, "V", "Voltage at which the blocked force holds", "printed: text", least=1.0e-3
    )
    capacitance: float = parameter(
        3.24e-9,
        "F",
        "Capacitance of one cone at x = 0",
        "inferred: 0.405 nF per layer, eight layers",
        least=1.0e-15,
    )


Input = ActuatorInput


@dataclass(frozen=True)
class State:
    """Loss so far [J] and the motion sample [s, m, m/s] up to which it is counted."""

    dissipated_energy: float
    sample_time: float
    sample_displacement: float
    sample_velocity: float


_TOP = ("top.voltage", "top.voltage_rate", "top.voltage_time")
_BOTTOM = ("bottom.voltage", "bottom.voltage_rate", "bottom.voltage_time")
_ALL = ("top", "bottom", "motion")


@dataclass(frozen=True)
class Output:
    """Force law, charge laws and energies; all follow the inputs directly."""

    force_value: float = provided("N", "Force on the spacer", port="force", depends=_ALL)
    force_stiffness: float = provided("N/m", "-dF/dx", port="force", order=1)
    force_damping: float = provided("N.s/m", "-dF/dv", port="force", order=1)
    force_rate: float = provided(
        "N/s", "dF/dt at fixed x and v", port="force", order=1, depends=("top", "bottom")
    )
    force_curvature: float = provided(
        "N/s2",
        "Coefficient of the squared time in the force law",
        port="force",
        order=2,
        depends=("top.square_curvature", "bottom.square_curvature"),
    )
    force_reference_displacement: float = provided(
        "m", "Displacement at which the law holds", port="force", order=1, depends=("motion",)
    )
    force_reference_velocity: float = provided(
        "m/s",
        "Velocity at which the law holds",
        port="force",
        order=1,
        depends=("motion.velocity",),
    )
    force_reference_time: float = provided(
        "s", "Time at which the law holds", port="force", order=1
    )
    top_charge: float = provided(
        "C", "Charge of the top cone", port="top", depends=(*_TOP, "motion")
    )
    top_capacitance: float = provided("F", "dQ/dV of the top cone", port="top", depends=("motion",))
    top_motional_current: float = provided(
        "A",
        "dQ/dx times velocity, top cone",
        port="top",
        order=1,
        depends=(*_TOP, "motion.velocity"),
    )
    top_capacitance_rate: float = provided(
        "F/s",
        "dC/dx times velocity, top cone",
        port="top",
        order=2,
        depends=("motion.velocity",),
    )
    top_capacitance_by_square: float = provided(
        "F/V2",
        "Derivative of Q/V by V^2, top cone",
        port="top",
        order=2,
    )
    top_charge_curvature: float = provided(
        "A/s",
        "Coefficient of the squared time in the charge law, top cone",
        port="top",
        order=2,
        depends=(*_TOP, "motion"),
    )
    top_coenergy: float = provided(
        "J",
        "Integral of Q dV up to the reference voltage, top cone",
        port="top",
        order=1,
        depends=(*_TOP, "motion"),
    )
    top_coenergy_rate: float = provided(
        "W",
        "Rate of the co-energy by the motion, top cone",
        port="top",
        order=1,
        depends=(*_TOP, "motion.velocity"),
    )
    top_coenergy_curvature: float = provided(
        "W/s",
        "Coefficient of the squared time in the co-energy, top cone",
        port="top",
        order=2,
        depends=(*_TOP, "motion"),
    )
    top_reference_voltage: float = provided(
        "V", "Voltage at which the top charge law holds", port="top", depends=_TOP
    )
    top_charge_time: float = provided(
        "s", "Time at which the top charge law holds", port="top", order=1
    )
    bottom_charge: float = provided(
        "C", "Charge of the bottom cone", port="bottom", depends=(*_BOTTOM, "motion")
    )
    bottom_capacitance: float = provided(
        "F", "dQ/dV of the bottom cone", port="bottom", depends=("motion",)
    )
    bottom_motional_current: float = provided(
        "A",
        "dQ/dx times velocity, bottom cone",
        port="bottom",
        order=1,
        depends=(*_BOTTOM, "motion.velocity"),
    )
    bottom_capacitance_rate: float = provided(
        "F/s",
        "dC/dx times velocity, bottom cone",
        port="bottom",
        order=2,
        depends=("motion.velocity",),
    )
    bottom_capacitance_by_square: float = provided(
        "F/V2",
        "Derivative of Q/V by V^2, bottom cone",
        port="bottom",
        order=2,
    )
    bottom_charge_curvature: float = provided(
        "A/s",
        "Coefficient of the squared time in the charge law, bottom cone",
        port="bottom",
        order=2,
        depends=(*_BOTTOM, "motion"),
    )
    bottom_coenergy: float = provided(
        "J",
        "Integral of Q dV up to the reference voltage, bottom cone",
        port="bottom",
        order=1,
        depends=(*_BOTTOM, "motion"),
    )
    bottom_coenergy_rate: float = provided(
        "W",
        "Rate of the co-energy by the motion, bottom cone",
        port="bottom",
        order=1,
        depends=(*_BOTTOM, "motion.velocity"),
    )
    bottom_coenergy_curvature: float = provided(
        "W/s",
        "Coefficient of the squared time in the co-energy, bottom cone",
        port="bottom",
        order=2,
        depends=(*_BOTTOM, "motion"),
    )
    bottom_reference_voltage: float = provided(
        "V", "Voltage at which the bottom charge law holds", port="bottom", depends=_BOTTOM
    )
    bottom_charge_time: float = provided(
        "s", "Time at which the bottom charge law holds", port="bottom", order=1
    )
    elastic_energy: float = provided("J", "Energy in the spring", depends=("motion",))
    electrical_energy: float = provided(
        "J", "Energy in both electric fields", depends=(*_TOP, *_BOTTOM, "motion")
    )
    dissipated_energy: float = provided("J", "Loss in the damping", depends=("motion",))


def damping(p: Params) -> float:
    """Total viscous coefficient [N s/m]: c + eta K / (2 pi f)."""
    return p.damping + p.loss_factor * p.stiffness / (2.0 * math.pi * p.loss_frequency)


def force_per_square(p: Params) -> float:
    """Electrostatic force per V^2 of one cone [N/V2]."""
    return p.blocked_force / (p.rated_voltage * p.rated_voltage)


def capacitance(p: Params, side: float, displacement: float) -> float:
    """Capacitance [F] of the cone on `side` (+1 top, -1 bottom); `ValueError` where it vanishes."""
    value = p.capacitance + 2.0 * side * force_per_square(p) * displacement
    if value <= 0.0:
        raise ValueError(
            "the displacement is beyond the point where a cone has no capacitance left"
        )
    return value


def passive_force(p: Params, displacement: float, velocity: float) -> float:
    """-K x - c v [N]."""
    return -p.stiffness * displacement - damping(p) * velocity


def square_at(voltage: float, rate: float, curvature: float, s: float) -> float:
    """V^2 [V2] at `s` after the reference time of the voltage law."""
    return voltage * voltage + 2.0 * voltage * rate * s + curvature * s * s


def square_rate_at(voltage: float, rate: float, curvature: float, s: float) -> float:
    """d(V^2)/dt [V2/s] at `s` after the reference time of the voltage law."""
    return 2.0 * voltage * rate + 2.0 * curvature * s


def initial(p: Params, u: Input, t: float) -> State:
    return State(
        dissipated_energy=0.0,
        sample_time=t,
        sample_displacement=u.motion_displacement,
        sample_velocity=u.motion_velocity,
    )


def loss_since_sample(p: Params, x: State, u: Input, t: float) -> float:
    """Loss [J] between the last motion sample and the one on the input now."""
    time = t - elapsed(t, u.motion_reference_time)
    span = time - x.sample_time
    if span <= 0.0:
        return 0.0
    mean = (u.motion_displacement - x.sample_displacement) / span
    square = mean_square(x.sample_velocity, u.motion_velocity, mean)
    return damping(p) * square * span


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Take in the motion sample on the input; there is nothing else to integrate."""
    return State(
        dissipated_energy=x.dissipated_energy + loss_since_sample(p, x, u, t),
        sample_time=t - elapsed(t, u.motion_reference_time),
        sample_displacement=u.motion_displacement,
        sample_velocity=u.motion_velocity,
    )


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    """Laws at time `t`, the motion carried on from its sample at constant velocity."""
    velocity = u.motion_velocity
    displacement = u.motion_displacement + velocity * elapsed(t, u.motion_reference_time)
    since_top = elapsed(t, u.top_voltage_time)
    since_bottom = elapsed(t, u.bottom_voltage_time)
    top = u.top_voltage + u.top_voltage_rate * since_top
    bottom = u.bottom_voltage + u.bottom_voltage_rate * since_bottom
    top_square = square_at(u.top_voltage, u.top_voltage_rate, u.top_square_curvature, since_top)
    bottom_square = square_at(
        u.bottom_voltage, u.bottom_voltage_rate, u.bottom_square_curvature, since_bottom
    )
    slope = force_per_square(p)
    rate = square_rate_at(
        u.top_voltage, u.top_voltage_rate, u.top_square_curvature, since_top
    ) - square_rate_at(
        u.bottom_voltage, u.bottom_voltage_rate, u.bottom_square_curvature, since_bottom
    )
    sampled = t - elapsed(t, u.motion_reference_time)
    acceleration = acceleration_between(
        x.sample_displacement,
        x.sample_velocity,
        u.motion_displacement,
        velocity,
        sampled - x.sample_time,
    )
    top_capacitance = capacitance(p, 1.0, displacement)
    bottom_capacitance = capacitance(p, -1.0, displacement)
    force = passive_force(p, displacement, velocity) + slope * (top_square - bottom_square)
    return Output(
        force_value=force,
        force_stiffness=p.stiffness,
        force_damping=damping(p),
        force_rate=slope * rate,
        force_curvature=slope * (u.top_square_curvature - u.bottom_square_curvature),
        force_reference_displacement=displacement,
        force_reference_velocity=velocity,
        force_reference_time=t,
        top_charge=top_capacitance * top,
        top_capacitance=top_capacitance,
        top_motional_current=2.0 * slope * velocity * top,
        top_capacitance_rate=2.0 * slope * velocity,
        top_capacitance_by_square=0.0,
        top_charge_curvature=slope * acceleration * top,
        top_coenergy=0.5 * top_capacitance * top * top,
        top_coenergy_rate=slope * velocity * top * top,
        top_coenergy_curvature=0.5 * slope * acceleration * top * top,
        top_reference_voltage=top,
        top_charge_time=t,
        bottom_charge=bottom_capacitance * bottom,
        bottom_capacitance=bottom_capacitance,
        bottom_motional_current=-2.0 * slope * velocity * bottom,
        bottom_capacitance_rate=-2.0 * slope * velocity,
        bottom_capacitance_by_square=0.0,
        bottom_charge_curvature=-slope * acceleration * bottom,
        bottom_coenergy=0.5 * bottom_capacitance * bottom * bottom,
        bottom_coenergy_rate=-slope * velocity * bottom * bottom,
        bottom_coenergy_curvature=-0.5 * slope * acceleration * bottom * bottom,
        bottom_reference_voltage=bottom,
        bottom_charge_time=t,
        elastic_energy=0.5 * p.stiffness * displacement * displacement,
        electrical_energy=0.5
        * (top_capacitance * top * top + bottom_capacitance * bottom * bottom),
        dissipated_energy=x.dissipated_energy + loss_since_sample(p, x, u, t),
    )
