"""Ports that more than one part receives: the actuators' and the mechanisms'."""

from __future__ import annotations

from dataclasses import dataclass

from .quantity import NO_REFERENCE, received


@dataclass(frozen=True)
class ActuatorInput:
    """Electrode voltages as laws in time, and the motion of the spacer."""

    top_voltage: float = received(0.0, "V", "Voltage of the top cone", port="top")
    top_voltage_rate: float = received(0.0, "V/s", "dV/dt of the top cone", port="top", order=1)
    top_square_curvature: float = received(
        0.0, "V2/s2", "Coefficient of s^2 in V^2(t) of the top cone", port="top", order=2
    )
    top_voltage_time: float = received(
        NO_REFERENCE, "s", "Time at which the top voltage holds", port="top", order=1
    )
    bottom_voltage: float = received(0.0, "V", "Voltage of the bottom cone", port="bottom")
    bottom_voltage_rate: float = received(
        0.0, "V/s", "dV/dt of the bottom cone", port="bottom", order=1
    )
    bottom_square_curvature: float = received(
        0.0, "V2/s2", "Coefficient of s^2 in V^2(t) of the bottom cone", port="bottom", order=2
    )
    bottom_voltage_time: float = received(
        NO_REFERENCE, "s", "Time at which the bottom voltage holds", port="bottom", order=1
    )
    motion_displacement: float = received(0.0, "m", "Displacement of the spacer", port="motion")
    motion_velocity: float = received(0.0, "m/s", "Velocity of the spacer", port="motion")
    motion_reference_time: float = received(
        NO_REFERENCE, "s", "Time at which the motion holds", port="motion", order=1
    )


@dataclass(frozen=True)
class ForceInput:
    """Force law of the actuator; a plain number needs `value` alone."""

    force_value: float = received(0.0, "N", "Force at the reference point", port="force")
    force_stiffness: float = received(0.0, "N/m", "-dF/dx", port="force", order=1)
    force_damping: float = received(0.0, "N.s/m", "-dF/dv", port="force", order=1)
    force_rate: float = received(0.0, "N/s", "dF/dt at fixed x and v", port="force", order=1)
    force_curvature: float = received(
        0.0, "N/s2", "Coefficient of the squared time in the force law", port="force", order=2
    )
    force_reference_displacement: float = received(
        0.0, "m", "Displacement at which the law holds", port="force", order=1
    )
    force_reference_velocity: float = received(
        0.0, "m/s", "Velocity at which the law holds", port="force", order=1
    )
    force_reference_time: float = received(
        NO_REFERENCE, "s", "Time at which the law holds", port="force", order=1
    )
