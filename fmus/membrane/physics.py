"""Double cone of dielectric elastomer films, n layers each, from one potential.

With the heights h_top = L/2 + x, h_bottom = L/2 - x and Pi(h, V) the potential of a cone at
equilibrium (ritz_solver.py; its table in potential.py),

    F = -dPi/dh(h_top, V_top) + dPi/dh(h_bottom, V_bottom) - losses,    Q = -dPi/dV,

so that charging the top cone lets it go and the spacer moves towards it. Every member of
the ports is an exact derivative of the same Pi. The shape follows height and voltage without
delay: the film's own inertia (8 mg per cone of 20 mm) is neglected.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..constants import VACUUM_PERMITTIVITY
from ..law import acceleration_between, elapsed
from ..ports import ActuatorInput
from ..quantity import parameter, provided
from . import loss
from .potential import evaluated, extremes
from .tables import FILMS, PRESTRETCH


@dataclass(frozen=True)
class Params:
    """Film, stack and loss of the double cone."""

    film: float = parameter(
        1.0,
        "1",
        "Shape and material whose table is used: radius ratio, Ogden set, pre-stretch",
        "chosen: the vehicle's; a/b of 0.1 calibrated on table 2",
        choices=FILMS,
    )
    outer_radius: float = parameter(
        13.0e-3, "m", "Outer radius b", "printed: table 3", least=1.0e-6
    )
    spacer: float = parameter(
        13.0e-3, "m", "Height L of the spacer between the cones", "printed: table 3", least=1.0e-6
    )
    thickness: float = parameter(
        40.0e-6, "m", "Thickness of a layer before pre-stretch", "printed: text", least=1.0e-9
    )
    modulus: float = parameter(
        1.287e5,
        "Pa",
        "First Ogden modulus; the others keep their ratio",
        "printed: equation 5",
        least=1.0,
    )
    permittivity: float = parameter(
        2.65,
        "1",
        "Relative permittivity",
        "calibrated: figure 3, 2 mm at 1 Hz; 2.8 to 3.2 is usual for silicone",
        least=1.0e-3,
    )
    layers: float = parameter(
        8.0, "1", "Layers per cone", "printed: text; per cone, decoded from table 2", least=1.0e-3
    )
    damping: float = parameter(
        0.0, "N.s/m", "Viscous damping beside the loss factor", "chosen: none", least=0.0
    )
    loss_factor: float = parameter(
        0.187,
        "1",
        "Loss factor eta of the passive stiffness at the loss frequency, growing as f^0.35",
        "calibrated: table 1, the five displacements; the exponent with them",
        least=0.0,
    )
    loss_frequency: float = parameter(
        52.0, "Hz", "Frequency at which the loss factor holds", "calibrated: figure 3", least=1.0e-3
    )
    storage_frequency: float = parameter(
        0.0,
        "Hz",
        "Frequency at which the branches leave the stiffness as it is without them",
        "inferred: 0, the pull test at 0.01 mm/s gave the constants; the five resonances agree",
        least=0.0,
    )
    breakdown_field: float = parameter(
        1.5e8,
        "V/m",
        "Breakdown field, for the limits output",
        "assumed: not known for this film",
        least=1.0,
    )


Input = ActuatorInput


@dataclass(frozen=True)
class State:
    """Relaxation branches, losses [J over stiffness], the last motion sample, and constants:
    loss stiffness eta K and the relief that levels the branches' storage [N/m], and the
    potential at rest [J]."""

    u0: float
    u1: float
    u2: float
    u3: float
    branch_loss: float
    viscous_loss: float
    sample_time: float
    sample_displacement: float
    sample_velocity: float
    interval: float
    loss_stiffness: float
    relief: float
    rest: float


@dataclass(frozen=True)
class Cone:
    """One cone in SI: Pi [J], F = dPi/dh [N], and derivatives by h and by V^2 = E."""

    energy: float
    force: float
    by_square: float
    stiffness: float
    force_by_square: float
    by_square_twice: float
    stiffness_by_square: float
    force_by_square_twice: float
    slack: float


@dataclass(frozen=True)
class Electric:
    """What the voltage adds to -Pi [J] and its derivatives by h: the co-energy, the integral of
    Q dV from zero volts at this height."""

    energy: float
    force: float
    stiffness: float


_TOP = ("top.voltage", "top.voltage_rate", "top.voltage_time")
_BOTTOM = ("bottom.voltage", "bottom.voltage_rate", "bottom.voltage_time")
_ALL = ("top", "bottom", "motion")


@dataclass(frozen=True)
class Output:
    """Force law, charge laws and energies; all follow the inputs directly."""

    force_value: float = provided(
        "N", "Force on the spacer", port="force", depends=(*_TOP, *_BOTTOM, "motion")
    )
    force_stiffness: float = provided(
        "N/m", "-dF/dx", port="force", order=1, depends=(*_TOP, *_BOTTOM, "motion")
    )
    force_damping: float = provided("N.s/m", "-dF/dv", port="force", order=1)
    force_rate: float = provided(
        "N/s", "dF/dt at fixed x and v", port="force", order=1, depends=_ALL
    )
    force_curvature: float = provided(
        "N/s2",
        "Coefficient of the squared time in the force law",
        port="force",
        order=2,
        depends=_ALL,
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
    top_capacitance: float = provided(
        "F", "dQ/dV of the top cone", port="top", depends=(*_TOP, "motion")
    )
    top_motional_current: float = provided(
        "A",
        "dQ/dx times velocity, top cone",
        port="top",
        order=1,
        depends=(*_TOP, "motion"),
    )
    top_capacitance_rate: float = provided(
        "F/s",
        "Rate of dQ/dV by the motion, top cone",
        port="top",
        order=2,
        depends=(*_TOP, "motion"),
    )
    top_capacitance_by_square: float = provided(
        "F/V2",
        "Derivative of Q/V by V^2, top cone",
        port="top",
        order=2,
        depends=(*_TOP, "motion"),
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
        depends=(*_TOP, "motion"),
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
        "F", "dQ/dV of the bottom cone", port="bottom", depends=(*_BOTTOM, "motion")
    )
    bottom_motional_current: float = provided(
        "A",
        "dQ/dx times velocity, bottom cone",
        port="bottom",
        order=1,
        depends=(*_BOTTOM, "motion"),
    )
    bottom_capacitance_rate: float = provided(
        "F/s",
        "Rate of dQ/dV by the motion, bottom cone",
        port="bottom",
        order=2,
        depends=(*_BOTTOM, "motion"),
    )
    bottom_capacitance_by_square: float = provided(
        "F/V2",
        "Derivative of Q/V by V^2, bottom cone",
        port="bottom",
        order=2,
        depends=(*_BOTTOM, "motion"),
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
        depends=(*_BOTTOM, "motion"),
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
    elastic_energy: float = provided(
        "J",
        "Elastic energy of films and relaxation branches, from that at rest",
        depends=(*_TOP, *_BOTTOM, "motion"),
    )
    electrical_energy: float = provided(
        "J", "Energy in both electric fields, Q V/2", depends=(*_TOP, *_BOTTOM, "motion")
    )
    dissipated_energy: float = provided("J", "Loss in the film", depends=("motion",))
    top_peak_field: float = provided(
        "V/m", "Largest true field in the top cone", depends=(*_TOP, "motion")
    )
    bottom_peak_field: float = provided(
        "V/m", "Largest true field in the bottom cone", depends=(*_BOTTOM, "motion")
    )
    top_hoop_stress: float = provided(
        "Pa", "Least nominal hoop stress in the top cone", depends=(*_TOP, "motion")
    )
    bottom_hoop_stress: float = provided(
        "Pa", "Least nominal hoop stress in the bottom cone", depends=(*_BOTTOM, "motion")
    )
    limits: float = provided(
        "1",
        "Sum of limits passed: 1 hoop tension, 2 table left below, 4 slack, 8 breakdown",
        depends=(*_TOP, *_BOTTOM, "motion"),
    )


def volume(p: Params) -> float:
    """2 pi n T b^2 mu_1 / lp^2 [J]: unit of the potential."""
    lp = PRESTRETCH[int(p.film) - 1]
    area = p.outer_radius * p.outer_radius
    return 2.0 * math.pi * p.layers * p.thickness * area * p.modulus / (lp * lp)


def loading(p: Params) -> float:
    """e per V^2: eps/(mu_1 T^2) [1/V2]."""
    return VACUUM_PERMITTIVITY * p.permittivity / (p.modulus * p.thickness * p.thickness)


def cone(p: Params, height: float, square: float) -> Cone:
    """One cone at a height [m] and V^2 [V2]; `ValueError` above its table."""
    unit = volume(p)
    b = p.outer_radius
    e = loading(p)
    film = int(p.film) - 1
    g, gx, ge, gxx, gxe, gee, gxxe, gxee, slack = evaluated(film, height / b, e * square)
    by_height = unit / b
    by_square = unit * e
    return Cone(
        energy=unit * g,
        force=by_height * gx,
        by_square=by_square * ge,
        stiffness=by_height / b * gxx,
        force_by_square=by_height * e * gxe,
        by_square_twice=by_square * e * gee,
        stiffness_by_square=by_height / b * e * gxxe,
        force_by_square_twice=by_height * e * e * gxee,
        slack=slack,
    )


def electric(p: Params, height: float, square: float, whole: Cone) -> Electric:
    """The voltage's share of a cone, given the whole of it."""
    if square == 0.0:
        return Electric(energy=0.0, force=0.0, stiffness=0.0)
    passive = cone(p, height, 0.0)
    return Electric(
        energy=passive.energy - whole.energy,
        force=passive.force - whole.force,
        stiffness=passive.stiffness - whole.stiffness,
    )


def branches(x: State) -> loss.Branches:
    """The relaxation branches that the state carries."""
    return loss.Branches(u0=x.u0, u1=x.u1, u2=x.u2, u3=x.u3, loss=x.branch_loss)


def initial(p: Params, u: Input, t: float) -> State:
    """Relaxed branches; `ValueError` where the neutral pose is not in the film's table."""
    centre = cone(p, 0.5 * p.spacer, 0.0)
    eta = 2.0 * centre.stiffness * loss.scale(p.loss_factor, p.loss_frequency)
    return State(
        u0=0.0,
        u1=0.0,
        u2=0.0,
        u3=0.0,
        branch_loss=0.0,
        viscous_loss=0.0,
        sample_time=t,
        sample_displacement=u.motion_displacement,
        sample_velocity=u.motion_velocity,
        interval=0.0,
        loss_stiffness=eta,
        relief=eta * loss.storage(p.storage_frequency),
        rest=2.0 * centre.energy,
    )


def sampled(p: Params, x: State, u: Input, t: float) -> State:
    """State with the motion sample on the input taken in.

    Between samples the velocity is the parabola through both ends and the mean that the
    displacements give.
    """
    time = t - elapsed(t, u.motion_reference_time)
    span = time - x.sample_time
    if span <= 0.0:
        return x
    mean = (u.motion_displacement - x.sample_displacement) / span
    first = x.sample_velocity
    last = u.motion_velocity
    middle = 0.25 * (6.0 * mean - first - last)
    b = branches(x)
    if p.loss_factor > 0.0:
        b = loss.moved(b, first, middle, last, span)
    square = (first * first + 4.0 * middle * middle + last * last) / 6.0
    return State(
        u0=b.u0,
        u1=b.u1,
        u2=b.u2,
        u3=b.u3,
        branch_loss=b.loss,
        viscous_loss=x.viscous_loss + p.damping * square * span,
        sample_time=time,
        sample_displacement=u.motion_displacement,
        sample_velocity=u.motion_velocity,
        interval=span,
        loss_stiffness=x.loss_stiffness,
        relief=x.relief,
        rest=x.rest,
    )


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Take in the motion sample on the input; the film itself has no memory."""
    return sampled(p, x, u, t)


def limits(p: Params, top: Cone, bottom: Cone, hoop: float, field: float) -> float:
    """Sum of the limits passed: 1 hoop tension lost, 2 below the table, 4 slack, 8 breakdown."""
    total = 0.0
    if hoop < 0.0:
        total = total + 1.0
    if max(top.slack, bottom.slack) > 0.5:
        total = total + 2.0
    if max(top.slack, bottom.slack) > 1.5:
        total = total + 4.0
    if field > p.breakdown_field:
        total = total + 8.0
    return total


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    """Laws at time `t`, the motion carried on from its sample at constant velocity."""
    now = sampled(p, x, u, t)
    velocity = u.motion_velocity
    ahead = elapsed(t, u.motion_reference_time)
    displacement = u.motion_displacement + velocity * ahead
    acceleration = acceleration_between(
        x.sample_displacement,
        x.sample_velocity,
        u.motion_displacement,
        velocity,
        now.sample_time - x.sample_time,
    )
    since_top = elapsed(t, u.top_voltage_time)
    since_bottom = elapsed(t, u.bottom_voltage_time)
    vt = u.top_voltage + u.top_voltage_rate * since_top
    vb = u.bottom_voltage + u.bottom_voltage_rate * since_bottom
    rt = 2.0 * u.top_voltage * u.top_voltage_rate + 2.0 * u.top_square_curvature * since_top
    rb = (
        2.0 * u.bottom_voltage * u.bottom_voltage_rate
        + 2.0 * u.bottom_square_curvature * since_bottom
    )
    top = cone(p, 0.5 * p.spacer + displacement, vt * vt)
    bottom = cone(p, 0.5 * p.spacer - displacement, vb * vb)
    top_share = electric(p, 0.5 * p.spacer + displacement, vt * vt, top)
    bottom_share = electric(p, 0.5 * p.spacer - displacement, vb * vb, bottom)

    eta = x.loss_stiffness
    before = branches(now)
    b = before
    if ahead > 0.0 and eta > 0.0:
        b = loss.moved(b, velocity, velocity, velocity, ahead)
    answer = loss.reaction(before, b, velocity, ahead, max(now.interval, ahead))
    relief = x.relief
    held = relief * displacement - eta * answer.value - p.damping * velocity

    et, eb = loading(p) * vt * vt, loading(p) * vb * vb
    half = 0.5 * p.spacer / p.outer_radius
    shift = displacement / p.outer_radius
    top_stretch, top_hoop = extremes(int(p.film) - 1, half + shift, et)
    bottom_stretch, bottom_hoop = extremes(int(p.film) - 1, half - shift, eb)
    top_field = math.fabs(vt) / p.thickness * top_stretch
    bottom_field = math.fabs(vb) / p.thickness * bottom_stretch
    top_charge = -2.0 * vt * top.by_square
    bottom_charge = -2.0 * vb * bottom.by_square
    field = 0.5 * (top_charge * vt + bottom_charge * vb)
    potentials = top.energy + bottom.energy - x.rest
    spring = eta * loss.stored(b) - 0.5 * relief * displacement * displacement
    return Output(
        force_value=bottom.force - top.force + held,
        force_stiffness=top.stiffness + bottom.stiffness - relief + eta * answer.stiffness,
        force_damping=p.damping,
        force_rate=bottom.force_by_square * rb - top.force_by_square * rt - eta * answer.rate,
        force_curvature=bottom.force_by_square * u.bottom_square_curvature
        - top.force_by_square * u.top_square_curvature
        + 0.5 * bottom.force_by_square_twice * rb * rb
        - 0.5 * top.force_by_square_twice * rt * rt
        - eta * answer.curvature,
        force_reference_displacement=displacement,
        force_reference_velocity=velocity,
        force_reference_time=t,
        top_charge=top_charge,
        top_capacitance=-2.0 * top.by_square - 4.0 * vt * vt * top.by_square_twice,
        top_motional_current=-2.0 * vt * top.force_by_square * velocity,
        top_capacitance_rate=-2.0
        * (top.force_by_square + 2.0 * vt * vt * top.force_by_square_twice)
        * velocity,
        top_capacitance_by_square=-2.0 * top.by_square_twice,
        top_charge_curvature=-vt
        * (top.stiffness_by_square * velocity * velocity + top.force_by_square * acceleration),
        top_coenergy=top_share.energy,
        top_coenergy_rate=top_share.force * velocity,
        top_coenergy_curvature=0.5
        * (top_share.stiffness * velocity * velocity + top_share.force * acceleration),
        top_reference_voltage=vt,
        top_charge_time=t,
        bottom_charge=bottom_charge,
        bottom_capacitance=-2.0 * bottom.by_square - 4.0 * vb * vb * bottom.by_square_twice,
        bottom_motional_current=2.0 * vb * bottom.force_by_square * velocity,
        bottom_capacitance_rate=2.0
        * (bottom.force_by_square + 2.0 * vb * vb * bottom.force_by_square_twice)
        * velocity,
        bottom_capacitance_by_square=-2.0 * bottom.by_square_twice,
        bottom_charge_curvature=-vb
        * (
            bottom.stiffness_by_square * velocity * velocity - bottom.force_by_square * acceleration
        ),
        bottom_coenergy=bottom_share.energy,
        bottom_coenergy_rate=-bottom_share.force * velocity,
        bottom_coenergy_curvature=0.5
        * (bottom_share.stiffness * velocity * velocity - bottom_share.force * acceleration),
        bottom_reference_voltage=vb,
        bottom_charge_time=t,
        elastic_energy=potentials + field + spring,
        electrical_energy=field,
        dissipated_energy=eta * now.branch_loss + now.viscous_loss,
        top_peak_field=top_field,
        bottom_peak_field=bottom_field,
        top_hoop_stress=top_hoop * p.modulus,
        bottom_hoop_stress=bottom_hoop * p.modulus,
        limits=limits(p, top, bottom, min(top_hoop, bottom_hoop), max(top_field, bottom_field)),
    )
