"""Mass on the spacer: M x'' = F(x, x', t) - M g, with F the law of the `force` port and M the
mass of spacer, payload and what of the films moves with them.

Between two communication points the law is linear in x and x' and quadratic in time, so the
motion is an entire function of time: it is summed as a Taylor series, exact to rounding,
however stiff or damped the law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import elapsed
from ..ports import ForceInput
from ..quantity import parameter, provided

TERMS = 18
REACH = 1.0
LONGEST = 1.0e6


@dataclass(frozen=True)
class Params:
    """Mass, gravity and where the motion starts."""

    mass: float = parameter(
        0.603e-3, "kg", "Mass of spacer and payload", "printed: table 1, DEA 1", least=1.0e-9
    )
    film_mass: float = parameter(
        0.0,
        "kg",
        "Share of films, electrodes and air that moves with the spacer",
        "chosen: none, as in the paper's own simplification",
        least=0.0,
    )
    gravity: float = parameter(
        0.0, "m/s2", "Gravity along -x", "chosen: the bench axis is horizontal"
    )
    start_displacement: float = parameter(0.0, "m", "Displacement at start", "chosen: at rest")
    start_velocity: float = parameter(0.0, "m/s", "Velocity at start", "chosen: at rest")


Input = ForceInput


@dataclass(frozen=True)
class State:
    """Motion [m, m/s] and the work received through the port [J]."""

    displacement: float
    velocity: float
    force_work: float


@dataclass(frozen=True)
class Output:
    """Motion and energies."""

    motion_displacement: float = provided("m", "Displacement of the spacer", port="motion")
    motion_velocity: float = provided("m/s", "Velocity of the spacer", port="motion")
    motion_reference_time: float = provided(
        "s", "Time at which the motion holds", port="motion", order=1
    )
    displacement: float = provided("m", "Displacement of the spacer", least=-1.0, most=1.0)
    velocity: float = provided("m/s", "Velocity of the spacer", least=-1.0e4, most=1.0e4)
    kinetic_energy: float = provided("J", "Kinetic energy of the payload")
    potential_energy: float = provided("J", "Energy in gravity, zero at x = 0")
    force_work: float = provided("J", "Work received through the force port")


def moving(p: Params) -> float:
    """Mass [kg] that the force accelerates."""
    return p.mass + p.film_mass


def initial(p: Params, u: Input, t: float) -> State:
    return State(displacement=p.start_displacement, velocity=p.start_velocity, force_work=0.0)


def substeps(p: Params, u: Input, h: float) -> float:
    """Number of Taylor steps in `h` so that each spans at most `REACH` of the fastest rate."""
    rate = math.sqrt(math.fabs(u.force_stiffness) / moving(p))
    rate = rate + math.fabs(u.force_damping) / moving(p)
    count = math.ceil(h * rate / REACH)
    if count > LONGEST:
        raise ValueError(
            "the force law is too stiff for this step: lower the step or the stiffness"
        )
    return max(1.0, float(count))


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Motion after `h` [s]; force work from the change of kinetic and potential energy.

    With M x'' = f0 + f1 s + f2 s^2 - k x - c x' the Taylor coefficients obey
    (j+1)(j+2) M a[j+2] = f[j] - k a[j] - c (j+1) a[j+1].
    """
    count = substeps(p, u, h)
    span = h / count
    mass = moving(p)
    displacement = x.displacement
    velocity = x.velocity
    start = elapsed(t, u.force_reference_time)
    for i in range(int(count)):
        s = start + float(i) * span
        f0 = (
            u.force_value
            + u.force_stiffness * u.force_reference_displacement
            + u.force_damping * u.force_reference_velocity
            + u.force_rate * s
            + u.force_curvature * s * s
            - mass * p.gravity
        )
        f1 = u.force_rate + 2.0 * u.force_curvature * s
        f2 = u.force_curvature
        lower = displacement
        upper = velocity * span
        displacement = lower + upper
        velocity = upper
        for j in range(TERMS):
            force = 0.0
            if j == 0:
                force = f0
            elif j == 1:
                force = f1 * span
            elif j == 2:
                force = f2 * span * span
            order = float(j + 1)
            following = (
                (force - u.force_stiffness * lower) * span * span
                - u.force_damping * span * order * upper
            ) / (mass * order * (order + 1.0))
            lower = upper
            upper = following
            displacement = displacement + upper
            velocity = velocity + (order + 1.0) * upper
        velocity = velocity / span
    gained = 0.5 * mass * (velocity * velocity - x.velocity * x.velocity)
    lifted = mass * p.gravity * (displacement - x.displacement)
    return State(
        displacement=displacement,
        velocity=velocity,
        force_work=x.force_work + gained + lifted,
    )


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    return Output(
        motion_displacement=x.displacement,
        motion_velocity=x.velocity,
        motion_reference_time=t,
        displacement=x.displacement,
        velocity=x.velocity,
        kinetic_energy=0.5 * moving(p) * x.velocity * x.velocity,
        potential_energy=moving(p) * p.gravity * x.displacement,
        force_work=x.force_work,
    )
