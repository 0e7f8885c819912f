"""What the amplifier is set to, receives and provides."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..quantity import NO_REFERENCE, UNLIMITED, parameter, provided, received
from .waveform import CHOICES


@dataclass(frozen=True)
class Params:
    """Drive signal, amplifier and electrode; limits of 1e30 and above do not limit."""

    waveform: float = parameter(
        5.0, "1", "Waveform of the function generator", "printed: square, text", choices=CHOICES
    )
    amplitude: float = parameter(
        1920.0, "V", "Amplitude", "printed: text", least=0.0, most=1.0e6, tunable=True
    )
    frequency: float = parameter(
        18.0, "Hz", "Frequency", "printed: figure 11, peak with full wings", least=0.0
    )
    start_phase: float = parameter(0.0, "rad", "Phase of the top channel at t = 0", "chosen")
    phase: float = parameter(
        math.pi, "rad", "Phase of the bottom channel before the top one", "printed: 180 degrees"
    )
    bottom_ratio: float = parameter(
        1.0,
        "1",
        "Amplitude of the bottom channel over that of the top one",
        "printed: equal",
        tunable=True,
    )
    soft_start: float = parameter(
        0.0, "s", "Duration of the smooth rise at start", "chosen: none", least=0.0
    )
    bandwidth: float = parameter(
        UNLIMITED, "Hz", "-3 dB bandwidth B of the amplifier", "assumed: no limit", least=1.0e-3
    )
    slew_rate: float = parameter(
        UNLIMITED, "V/s", "Largest rate S of the output", "assumed: no limit", least=1.0e-3
    )
    current_limit: float = parameter(
        UNLIMITED,
        "A",
        "Largest current per channel",
        "assumed: no limit",
        least=1.0e-12,
        tunable=True,
    )
    power_limit: float = parameter(
        UNLIMITED,
        "W",
        "Largest power per channel",
        "assumed: no limit; the paper quotes 1 W for its amplifier",
        least=1.0e-9,
        tunable=True,
    )
    resistance: float = parameter(
        1.0e5,
        "Ohm",
        "Resistance R of one electrode pair",
        "assumed: the droop of table 2 at eight layers suits 0.1 to 0.2 MOhm",
        least=0.0,
        most=1.0e12,
    )


@dataclass(frozen=True)
class Input:
    """External command per channel, and the charge laws of both electrodes."""

    command_top: float = received(0.0, "V", "External command, top channel", port="command")
    command_bottom: float = received(0.0, "V", "External command, bottom channel", port="command")
    top_charge: float = received(0.0, "C", "Charge at the reference voltage, top", port="top")
    top_capacitance: float = received(3.24e-9, "F", "dQ/dV, top", port="top")
    top_motional_current: float = received(
        0.0, "A", "dQ/dx times velocity, top", port="top", order=1
    )
    top_capacitance_rate: float = received(0.0, "F/s", "Rate of dQ/dV, top", port="top", order=2)
    top_capacitance_by_square: float = received(
        0.0, "F/V2", "Derivative of Q/V by V^2, top", port="top", order=2
    )
    top_charge_curvature: float = received(
        0.0, "A/s", "Coefficient of s^2 in the charge, top", port="top", order=2
    )
    top_coenergy: float = received(
        0.0, "J", "Integral of Q dV up to the reference voltage, top", port="top", order=1
    )
    top_coenergy_rate: float = received(
        0.0, "W", "Rate of the co-energy by the motion, top", port="top", order=1
    )
    top_coenergy_curvature: float = received(
        0.0, "W/s", "Coefficient of s^2 in the co-energy, top", port="top", order=2
    )
    top_reference_voltage: float = received(
        0.0, "V", "Voltage at which the charge law holds, top", port="top"
    )
    top_charge_time: float = received(
        NO_REFERENCE, "s", "Time at which the charge law holds, top", port="top", order=1
    )
    bottom_charge: float = received(
        0.0, "C", "Charge at the reference voltage, bottom", port="bottom"
    )
    bottom_capacitance: float = received(3.24e-9, "F", "dQ/dV, bottom", port="bottom")
    bottom_motional_current: float = received(
        0.0, "A", "dQ/dx times velocity, bottom", port="bottom", order=1
    )
    bottom_capacitance_rate: float = received(
        0.0, "F/s", "Rate of dQ/dV, bottom", port="bottom", order=2
    )
    bottom_capacitance_by_square: float = received(
        0.0, "F/V2", "Derivative of Q/V by V^2, bottom", port="bottom", order=2
    )
    bottom_charge_curvature: float = received(
        0.0, "A/s", "Coefficient of s^2 in the charge, bottom", port="bottom", order=2
    )
    bottom_coenergy: float = received(
        0.0, "J", "Integral of Q dV up to the reference voltage, bottom", port="bottom", order=1
    )
    bottom_coenergy_rate: float = received(
        0.0, "W", "Rate of the co-energy by the motion, bottom", port="bottom", order=1
    )
    bottom_coenergy_curvature: float = received(
        0.0, "W/s", "Coefficient of s^2 in the co-energy, bottom", port="bottom", order=2
    )
    bottom_reference_voltage: float = received(
        0.0, "V", "Voltage at which the charge law holds, bottom", port="bottom"
    )
    bottom_charge_time: float = received(
        NO_REFERENCE, "s", "Time at which the charge law holds, bottom", port="bottom", order=1
    )


@dataclass(frozen=True)
class Output:
    """Voltage laws, currents and energies."""

    top_voltage: float = provided("V", "Voltage, top", port="top", least=-1.0e7, most=1.0e7)
    top_voltage_rate: float = provided("V/s", "dV/dt, top", port="top", order=1)
    top_square_curvature: float = provided(
        "V2/s2", "Coefficient of s^2 in V^2(t), top", port="top", order=2
    )
    top_voltage_time: float = provided(
        "s", "Time at which the voltage holds, top", port="top", order=1
    )
    bottom_voltage: float = provided(
        "V", "Voltage, bottom", port="bottom", least=-1.0e7, most=1.0e7
    )
    bottom_voltage_rate: float = provided("V/s", "dV/dt, bottom", port="bottom", order=1)
    bottom_square_curvature: float = provided(
        "V2/s2", "Coefficient of s^2 in V^2(t), bottom", port="bottom", order=2
    )
    bottom_voltage_time: float = provided(
        "s", "Time at which the voltage holds, bottom", port="bottom", order=1
    )
    top_current: float = provided("A", "Current into the top electrode")
    bottom_current: float = provided("A", "Current into the bottom electrode")
    top_peak_current: float = provided("A", "Largest current of the last step, top")
    bottom_peak_current: float = provided("A", "Largest current of the last step, bottom")
    electrode_charge: float = provided("C", "Charge on both electrodes together")
    supplied_energy: float = provided("J", "Energy delivered by the amplifier's output")
    dissipated_energy: float = provided("J", "Loss in the electrode resistance")
    next_event_time: float = provided("s", "Time of the next edge; 1e30 without one")
