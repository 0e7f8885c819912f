"""High-voltage amplifier with two channels, each driving an RC electrode pair.

Per channel: the function generator's command u(t); the amplifier's voltage V_a with
V_a' = clamp((u - V_a) 2 pi B, -S, S); the electrode's charge with R q' = V_a - V(q, t), its
current bounded by the current limit and by power limit over output voltage. V(q, t) inverts
the charge law that comes through the channel's port.

What the receiver of the voltage needs is not the shape within a step but its effect: the
port carries V and V' at the end of the step and the coefficient of s^2 in V^2 that makes
the mean of V^2 over the step exact, edges and RC transients included.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..law import elapsed
from ..quantity import NO_REFERENCE, UNLIMITED, parameter, provided, received
from .electrode import Electrode, Law, charge_at, charged, chord, frozen, voltage, voltage_rate
from .relaxation import limited
from .waveform import CHOICES, CONSTANT, EXTERNAL, SQUARE, envelope, next_edge, piece_end, shape

PHASE_STEP = 0.1
LEAP = 0.02
"""Change of voltage over the amplitude above which a curved charge law is cut into chords."""

MOST_PIECES = 10000.0


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
    bottom_reference_voltage: float = received(
        0.0, "V", "Voltage at which the charge law holds, bottom", port="bottom"
    )
    bottom_charge_time: float = received(
        NO_REFERENCE, "s", "Time at which the charge law holds, bottom", port="bottom", order=1
    )


@dataclass(frozen=True)
class Channel:
    """One channel: amplifier and electrode at the end of a step, and the step's V^2."""

    drive: float
    charge: float
    voltage: float
    voltage_rate: float
    square_curvature: float
    current: float
    peak_current: float
    supplied: float
    loss: float


@dataclass(frozen=True)
class State:
    """Both channels, field by field."""

    top_drive: float
    top_charge: float
    top_voltage: float
    top_voltage_rate: float
    top_square_curvature: float
    top_current: float
    top_peak_current: float
    top_supplied: float
    top_loss: float
    bottom_drive: float
    bottom_charge: float
    bottom_voltage: float
    bottom_voltage_rate: float
    bottom_square_curvature: float
    bottom_current: float
    bottom_peak_current: float
    bottom_supplied: float
    bottom_loss: float


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


def drive_phase(p: Params, side: float) -> float:
    """Phase of a channel (+1 top, -1 bottom) at t = 0, in cycles."""
    if side > 0.0:
        return p.start_phase / (2.0 * math.pi)
    return (p.start_phase + p.phase) / (2.0 * math.pi)


def command(p: Params, u: Input, side: float, t: float, inside: float) -> float:
    """Command voltage [V] of a channel at `t`; `inside` is a time in the same smooth piece."""
    if p.waveform == EXTERNAL:
        if side > 0.0:
            return u.command_top
        return u.command_bottom
    offset = drive_phase(p, side)
    level = p.amplitude
    if side < 0.0:
        level = p.amplitude * p.bottom_ratio
    wave = shape(p.waveform, p.frequency * t + offset, p.frequency * inside + offset)
    return level * wave * envelope(p.soft_start, t)


def next_event(p: Params, t: float) -> float:
    """Time [s] of the next edge of either channel."""
    return min(
        next_edge(p.waveform, p.frequency, drive_phase(p, 1.0), t),
        next_edge(p.waveform, p.frequency, drive_phase(p, -1.0), t),
    )


def current_limit(p: Params, output: float) -> float:
    """Bound on the current [A] at an output voltage: current limit, and power over voltage."""
    return min(p.current_limit, p.power_limit / max(math.fabs(output), 1.0e-3))


def law_of(u: Input, side: float) -> Law:
    """The charge law on the input of one channel; `ValueError` without a capacitance."""
    if side > 0.0:
        law = Law(
            charge=u.top_charge,
            capacitance=u.top_capacitance,
            motional_current=u.top_motional_current,
            capacitance_rate=u.top_capacitance_rate,
            charge_curvature=u.top_charge_curvature,
            by_square=u.top_capacitance_by_square,
            reference_voltage=u.top_reference_voltage,
        )
    else:
        law = Law(
            charge=u.bottom_charge,
            capacitance=u.bottom_capacitance,
            motional_current=u.bottom_motional_current,
            capacitance_rate=u.bottom_capacitance_rate,
            charge_curvature=u.bottom_charge_curvature,
            by_square=u.bottom_capacitance_by_square,
            reference_voltage=u.bottom_reference_voltage,
        )
    if not law.capacitance > 0.0:
        raise ValueError("an electrode's capacitance is not positive")
    return law


def unconnected(u: Input, side: float, charge: float) -> bool:
    """Whether nothing is there to be charged, and nothing ever was.

    Other masters leave inputs at zero until the first exchange: an electrode that is without
    charge and without capacitance then waits. A capacitance that vanishes later is a fault.
    """
    if side > 0.0:
        return charge == 0.0 and u.top_capacitance == 0.0 and u.top_charge == 0.0
    return charge == 0.0 and u.bottom_capacitance == 0.0 and u.bottom_charge == 0.0


def idle(drive: float, supplied: float, loss: float) -> Channel:
    """A channel that nothing is connected to."""
    return Channel(
        drive=drive,
        charge=0.0,
        voltage=0.0,
        voltage_rate=0.0,
        square_curvature=0.0,
        current=0.0,
        peak_current=0.0,
        supplied=supplied,
        loss=loss,
    )


def law_age(u: Input, side: float, t: float) -> float:
    """Time [s] at `t` since the charge law of a channel held."""
    if side > 0.0:
        return elapsed(t, u.top_charge_time)
    return elapsed(t, u.bottom_charge_time)


def substeps(p: Params, t: float, span: float, curved: bool) -> float:
    """Number of parabolas that follow the drive over a smooth piece of `span` [s]."""
    count = 1.0
    if curved:
        count = 8.0
    if p.waveform != CONSTANT and p.waveform != SQUARE and p.waveform != EXTERNAL:
        count = max(count, math.ceil(2.0 * math.pi * p.frequency * span / PHASE_STEP))
    if t < p.soft_start:
        count = max(count, math.ceil(20.0 * span / p.soft_start))
    if p.bandwidth < UNLIMITED:
        count = max(count, min(64.0, math.ceil(4.0 * math.pi * p.bandwidth * span)))
    if p.current_limit < UNLIMITED:
        count = max(count, 4.0)
    if p.slew_rate < UNLIMITED or p.power_limit < UNLIMITED:
        count = max(count, 32.0)
    if count > MOST_PIECES:
        raise ValueError("the communication step spans more than 1000 cycles of the drive")
    return float(count)


def advance_channel(
    p: Params,
    u: Input,
    side: float,
    drive: float,
    charge: float,
    supplied: float,
    loss: float,
    t: float,
    h: float,
) -> Channel:
    """One channel over [t, t + h], cut at the edges of its drive."""
    if unconnected(u, side, charge):
        return idle(drive, supplied, loss)
    moving = law_of(u, side)
    age = law_age(u, side, t)
    law = frozen(moving, age + 0.5 * h)
    offset = drive_phase(p, side)
    e = Electrode(
        charge=charge, current=0.0, peak_current=0.0, square=0.0, supplied=supplied, loss=loss
    )
    ideal = p.bandwidth >= UNLIMITED and p.slew_rate >= UNLIMITED
    lag = max(1.0 / (2.0 * math.pi * p.bandwidth), 1.0e-12)
    level = p.waveform == CONSTANT or p.waveform == SQUARE or p.waveform == EXTERNAL
    pieces = 0.0
    piece_start = t
    stop = t + h
    while piece_start < stop:
        end = piece_end(p.waveform, p.frequency, offset, piece_start, stop)
        pieces = pieces + 1.0
        if pieces > MOST_PIECES:
            raise ValueError("the communication step spans more than 10000 edges of the drive")
        inside = 0.5 * (piece_start + end)
        curved = False
        if moving.by_square != 0.0:
            aim = command(p, u, side, end, inside)
            here = voltage(moving, e.charge, age + (piece_start - t))
            curved = math.fabs(aim - here) > LEAP * p.amplitude
        count = substeps(p, piece_start, end - piece_start, curved)
        span = (end - piece_start) / count
        for i in range(int(count)):
            start = piece_start + float(i) * span
            v0 = command(p, u, side, start, inside)
            v1 = 0.0
            v2 = 0.0
            if not level or start < p.soft_start:
                middle = command(p, u, side, start + 0.5 * span, inside)
                last = command(p, u, side, start + span, inside)
                v1 = (4.0 * middle - 3.0 * v0 - last) / span
                v2 = 2.0 * (v0 + last - 2.0 * middle) / (span * span)
            if ideal:
                drive = v0 + (v1 + v2 * span) * span
            else:
                middle = limited(drive, v0, v1, v2, lag, p.slew_rate, 0.5 * span)
                last = limited(drive, v0, v1, v2, lag, p.slew_rate, span)
                v0 = drive
                v1 = (4.0 * middle - 3.0 * v0 - last) / span
                v2 = 2.0 * (v0 + last - 2.0 * middle) / (span * span)
                drive = last
            since = age + (start - t)
            bound = p.current_limit
            if p.power_limit < UNLIMITED:
                aim = v0 + 0.5 * (v1 + 0.5 * v2 * span) * span
                bound = power_bound(p, law, voltage(law, e.charge, since), aim, span)
            if moving.by_square != 0.0:
                last = v0 + (v1 + v2 * span) * span
                law = chord(moving, e.charge, last, since + 0.5 * span)
            e = charged(e, law, since, p.resistance, bound, v0, v1, v2, span)
        piece_start = end
    ended = voltage(moving, e.charge, age + h)
    rate = voltage_rate(moving, ended, e.current, age + h)
    line = ended * ended - ended * rate * h
    return Channel(
        drive=drive,
        charge=e.charge,
        voltage=ended,
        voltage_rate=rate,
        square_curvature=3.0 * (e.square / h - line) / (h * h),
        current=e.current,
        peak_current=e.peak_current,
        supplied=e.supplied,
        loss=e.loss,
    )


def power_bound(p: Params, law: Law, now: float, aim: float, span: float) -> float:
    """Bound on the current [A] over a substep: that at its middle, by a predictor from `now`."""
    push = min(current_limit(p, now), math.fabs(aim - now) / max(p.resistance, 1.0))
    middle = now + 0.5 * math.copysign(push, aim - now) * span / law.capacitance
    return current_limit(p, middle)


def joined(top: Channel, bottom: Channel) -> State:
    """State of both channels."""
    return State(
        top_drive=top.drive,
        top_charge=top.charge,
        top_voltage=top.voltage,
        top_voltage_rate=top.voltage_rate,
        top_square_curvature=top.square_curvature,
        top_current=top.current,
        top_peak_current=top.peak_current,
        top_supplied=top.supplied,
        top_loss=top.loss,
        bottom_drive=bottom.drive,
        bottom_charge=bottom.charge,
        bottom_voltage=bottom.voltage,
        bottom_voltage_rate=bottom.voltage_rate,
        bottom_square_curvature=bottom.square_curvature,
        bottom_current=bottom.current,
        bottom_peak_current=bottom.peak_current,
        bottom_supplied=bottom.supplied,
        bottom_loss=bottom.loss,
    )


def uncharged(p: Params, u: Input, side: float, t: float) -> Channel:
    """Channel at V = 0, its amplifier at 0 too."""
    if unconnected(u, side, 0.0):
        return idle(0.0, 0.0, 0.0)
    law = law_of(u, side)
    charge = charge_at(law, 0.0, law_age(u, side, t))
    return Channel(
        drive=0.0,
        charge=charge,
        voltage=0.0,
        voltage_rate=0.0,
        square_curvature=0.0,
        current=0.0,
        peak_current=0.0,
        supplied=0.0,
        loss=0.0,
    )


def initial(p: Params, u: Input, t: float) -> State:
    """Both electrodes uncharged, the amplifier about to follow its command."""
    return joined(uncharged(p, u, 1.0, t), uncharged(p, u, -1.0, t))


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Both channels after `h` [s]."""
    return joined(
        advance_channel(p, u, 1.0, x.top_drive, x.top_charge, x.top_supplied, x.top_loss, t, h),
        advance_channel(
            p, u, -1.0, x.bottom_drive, x.bottom_charge, x.bottom_supplied, x.bottom_loss, t, h
        ),
    )


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    return Output(
        top_voltage=x.top_voltage,
        top_voltage_rate=x.top_voltage_rate,
        top_square_curvature=x.top_square_curvature,
        top_voltage_time=t,
        bottom_voltage=x.bottom_voltage,
        bottom_voltage_rate=x.bottom_voltage_rate,
        bottom_square_curvature=x.bottom_square_curvature,
        bottom_voltage_time=t,
        top_current=x.top_current,
        bottom_current=x.bottom_current,
        top_peak_current=x.top_peak_current,
        bottom_peak_current=x.bottom_peak_current,
        electrode_charge=x.top_charge + x.bottom_charge,
        supplied_energy=x.top_supplied + x.bottom_supplied,
        dissipated_energy=x.top_loss + x.bottom_loss,
        next_event_time=next_event(p, t),
    )
