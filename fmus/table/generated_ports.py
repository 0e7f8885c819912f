"""Inputs and outputs of the table, made by the build from its columns."""

from __future__ import annotations

from dataclasses import dataclass

from ..quantity import provided, received
from .data import HIGH, LOW
from .relation import first_slope, outside, place, value


@dataclass(frozen=True)
class Input:
    """Arguments of the table."""

    motion_flap_rate: float = received(
        0.0,
        "rad/s",
        "Argument of the table",
        port="motion",
        name="motion.flap_rate",
    )


@dataclass(frozen=True)
class Output:
    """What the table gives, and the slopes of it."""

    load_torque: float = provided(
        "N.m",
        "Tabulated over motion.flap_rate",
        port="load",
        order=0,
        depends=("motion.flap_rate",),
        name="load.torque",
    )
    load_added_inertia: float = provided(
        "kg.m2",
        "Tabulated over motion.flap_rate",
        port="load",
        order=0,
        depends=("motion.flap_rate",),
        name="load.added_inertia",
    )
    load_damping: float = provided(
        "N.m.s",
        "-d(load.torque)/d(motion.flap_rate)",
        port="load",
        order=1,
        depends=("motion.flap_rate",),
        name="load.damping",
    )
    load_reference_rate: float = provided(
        "rad/s",
        "Where the law holds",
        port="load",
        order=1,
        depends=("motion.flap_rate",),
        name="load.reference_rate",
    )
    load_added_inertia_slope: float = provided(
        "kg.m2.s",
        "d(load.added_inertia)/d(motion.flap_rate)",
        port="load",
        order=1,
        depends=("motion.flap_rate",),
        name="load.added_inertia_slope",
    )


def check_inside(u: Input) -> bool:
    """`ValueError` where an argument is outside of the table; else true."""
    if outside(u.motion_flap_rate, LOW, HIGH):
        raise ValueError(
            "motion.flap_rate is outside of the table, -120 to 120 rad/s: outside = hold or extend"
        )
    return True


def outputs_at(u: Input, how: float, beyond: float) -> Output:
    """Outputs at the arguments; `how` and `beyond` are parameters of the part."""
    here = place(u.motion_flap_rate, 0.0)
    return Output(
        load_torque=value(0, here, how, beyond),
        load_added_inertia=value(1, here, how, beyond),
        load_damping=-first_slope(0, here, how, beyond),
        load_reference_rate=u.motion_flap_rate,
        load_added_inertia_slope=first_slope(1, here, how, beyond),
    )
