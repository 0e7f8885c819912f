"""What the controller is set to, receives and provides."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..quantity import NO_REFERENCE, parameter, provided, received

FLAP_ANGLE = 1.0
CAPACITANCE = 2.0
SENSORS = ("flap_angle", "capacitance")
FITTED = (
    "calibrated: flapping-full-wings on the film model, a cycle each at 1750 to 1920 V, 15 to 21 Hz"
)
DESIGNED = "chosen: designed on the averaged linear model (README)"


@dataclass(frozen=True)
class Params:
    """Sensor, drive at start, what is held, gains and limits."""

    sensor: float = parameter(
        FLAP_ANGLE, "1", "What the stroke and its lag are read from", "chosen", choices=SENSORS
    )
    start_frequency: float = parameter(
        15.0, "Hz", "Drive frequency at start", "chosen: below resonance", least=1.0e-3
    )
    least_frequency: float = parameter(5.0, "Hz", "Lowest drive frequency", "chosen", least=1.0e-3)
    largest_frequency: float = parameter(
        50.0, "Hz", "Highest drive frequency", "chosen: above 34 Hz without wings", least=1.0e-3
    )
    start_drive: float = parameter(
        1.0,
        "1",
        "Drive at start: share of the largest squared voltage",
        "chosen: all",
        least=0.0,
        most=1.0,
    )
    largest_voltage: float = parameter(
        1920.0, "V", "Voltage of full drive", "printed: text", least=0.0, tunable=True
    )
    stroke_target: float = parameter(
        math.radians(63.0),
        "rad",
        "Stroke that is held, peak to peak",
        "printed: figure 11, 63 degrees with full wings",
        least=0.0,
        tunable=True,
    )
    lag_target: float = parameter(
        0.5 * math.pi,
        "rad",
        "Lag of the motion behind the drive that is held",
        "chosen: resonance",
        tunable=True,
    )
    lag_gain: float = parameter(
        0.0, "Hz/rad", "Frequency by error of the lag", DESIGNED, least=0.0, tunable=True
    )
    lag_integral_gain: float = parameter(
        4.0, "Hz/rad", "The same, summed once a cycle", DESIGNED, least=0.0, tunable=True
    )
    stroke_gain: float = parameter(
        0.045, "1/rad", "Drive by error of the stroke", DESIGNED, least=0.0, tunable=True
    )
    stroke_integral_gain: float = parameter(
        0.08, "1/rad", "The same, summed once a cycle", DESIGNED, least=0.0, tunable=True
    )
    start_phase: float = parameter(0.0, "rad", "Phase of the drive at t = 0", "chosen")
    rest_capacitance: float = parameter(
        2.5255e-9,
        "F",
        "Capacitance of a charged cone at flap angle 0, V = 0",
        FITTED,
        least=1.0e-15,
    )
    capacitance_by_square: float = parameter(9.586e-8, "1/V2", "Its relative growth by V^2", FITTED)
    angle_slope: float = parameter(9.25, "rad", "Flap angle by relative capacitance", FITTED)
    angle_curvature: float = parameter(
        -74.4, "rad", "Coefficient of the square of the relative capacitance", FITTED
    )
    angle_cubic: float = parameter(1076.0, "rad", "Coefficient of its cube", FITTED)
    noise: float = parameter(
        0.0,
        "1",
        "Standard deviation of each sample of the capacitance, relative",
        "chosen: none",
        least=0.0,
        tunable=True,
    )
    noise_seed: float = parameter(
        1.0, "1", "Seed of the noise, a whole number", "chosen", least=1.0, most=2147483646.0
    )


@dataclass(frozen=True)
class Input:
    """Motion of the wing, charge and voltage of both cones, and excitations for measurements."""

    motion_flap_angle: float = received(0.0, "rad", "Flap angle", port="motion")
    motion_flap_rate: float = received(0.0, "rad/s", "Flap rate", port="motion")
    motion_reference_time: float = received(
        NO_REFERENCE, "s", "Time at which the motion holds", port="motion", order=1
    )
    top_charge: float = received(0.0, "C", "Charge of the top cone", port="top")
    top_reference_voltage: float = received(0.0, "V", "Voltage of the top cone", port="top")
    top_charge_time: float = received(
        NO_REFERENCE, "s", "Time at which charge and voltage hold, top", port="top", order=1
    )
    bottom_charge: float = received(0.0, "C", "Charge of the bottom cone", port="bottom")
    bottom_reference_voltage: float = received(
        0.0, "V", "Voltage of the bottom cone", port="bottom"
    )
    bottom_charge_time: float = received(
        NO_REFERENCE, "s", "Time at which charge and voltage hold, bottom", port="bottom", order=1
    )
    excitation_frequency: float = received(
        0.0, "Hz", "Added to the drive frequency", port="excitation"
    )
    excitation_drive: float = received(0.0, "1", "Added to the drive", port="excitation")


@dataclass(frozen=True)
class Output:
    """Commands of the amplifier, and what the loop sees and does."""

    command_top: float = provided("V", "Command of the top channel", port="command", discrete=True)
    command_bottom: float = provided(
        "V", "Command of the bottom channel", port="command", discrete=True
    )
    frequency: float = provided("Hz", "Drive frequency", discrete=True)
    drive: float = provided("1", "Share of the largest squared voltage", discrete=True)
    voltage: float = provided("V", "Voltage of the drive", discrete=True)
    lag: float = provided(
        "rad", "Lag of the motion behind the drive over the last cycle", discrete=True
    )
    stroke: float = provided(
        "rad",
        "Twice the amplitude of the first harmonic of the last cycle, as it is sensed",
        discrete=True,
    )
    cycles: float = provided("1", "Drive cycles that were finished", discrete=True)
    next_event_time: float = provided("s", "Time of the next edge of the drive", discrete=True)
