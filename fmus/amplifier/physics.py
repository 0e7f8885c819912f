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
from ..quantity import UNLIMITED
from .account import Account, Coenergy, lost, mark_of, work_until
from .electrode import Electrode, Law, charge_at, charged, chord, frozen, voltage, voltage_rate
from .interface import Input as Input
from .interface import Output as Output
from .interface import Params as Params
from .relaxation import limited
from .waveform import CONSTANT, EXTERNAL, SQUARE, envelope, next_edge, piece_end, shape

PHASE_STEP = 0.1
LEAP = 0.02
"""Change of voltage over the amplitude above which a piece is cut: a curved charge law into
chords, and V^2 finely enough for its first moment."""

MOST_PIECES = 10000.0


@dataclass(frozen=True)
class Channel:
    """One channel: amplifier and electrode at the end of a step, the step's V^2, and energies:
    supplied, lost, and the account of what went into motion."""

    drive: float
    charge: float
    voltage: float
    voltage_rate: float
    square_curvature: float
    current: float
    peak_current: float
    supplied: float
    loss: float
    delivered: float
    coupled: float
    mark_square: float
    mark_power: float
    mark_power_rate: float
    mark_span: float
    mark_area: float
    mark_moment: float


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
    top_delivered: float
    top_coupled: float
    top_mark_square: float
    top_mark_power: float
    top_mark_power_rate: float
    top_mark_span: float
    top_mark_area: float
    top_mark_moment: float
    bottom_drive: float
    bottom_charge: float
    bottom_voltage: float
    bottom_voltage_rate: float
    bottom_square_curvature: float
    bottom_current: float
    bottom_peak_current: float
    bottom_supplied: float
    bottom_loss: float
    bottom_delivered: float
    bottom_coupled: float
    bottom_mark_square: float
    bottom_mark_power: float
    bottom_mark_power_rate: float
    bottom_mark_span: float
    bottom_mark_area: float
    bottom_mark_moment: float


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


def coenergy_of(u: Input, side: float) -> Coenergy:
    """The co-energy on the input of one channel."""
    if side > 0.0:
        return Coenergy(
            value=u.top_coenergy, rate=u.top_coenergy_rate, curvature=u.top_coenergy_curvature
        )
    return Coenergy(
        value=u.bottom_coenergy,
        rate=u.bottom_coenergy_rate,
        curvature=u.bottom_coenergy_curvature,
    )


def unconnected(u: Input, side: float, charge: float) -> bool:
    """Whether nothing is there to be charged, and nothing ever was.

    Other masters leave inputs at zero until the first exchange: an electrode that is without
    charge and without capacitance then waits. A capacitance that vanishes later is a fault.
    """
    if side > 0.0:
        return charge == 0.0 and u.top_capacitance == 0.0 and u.top_charge == 0.0
    return charge == 0.0 and u.bottom_capacitance == 0.0 and u.bottom_charge == 0.0


def idle(c: Channel) -> Channel:
    """A channel that nothing is connected to."""
    return Channel(
        drive=c.drive,
        charge=0.0,
        voltage=0.0,
        voltage_rate=0.0,
        square_curvature=0.0,
        current=0.0,
        peak_current=0.0,
        supplied=c.supplied,
        loss=c.loss,
        delivered=c.delivered,
        coupled=c.coupled,
        mark_square=c.mark_square,
        mark_power=c.mark_power,
        mark_power_rate=c.mark_power_rate,
        mark_span=c.mark_span,
        mark_area=c.mark_area,
        mark_moment=c.mark_moment,
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


def advance_channel(p: Params, u: Input, side: float, c: Channel, t: float, h: float) -> Channel:
    """One channel over [t, t + h], cut at the edges of its drive."""
    if unconnected(u, side, c.charge):
        return idle(c)
    moving = law_of(u, side)
    age = law_age(u, side, t)
    law = frozen(moving, age + 0.5 * h)
    offset = drive_phase(p, side)
    drive = c.drive
    w = coenergy_of(u, side)
    mark = mark_of(moving, w, age)
    entry = account_of(c)
    moment = 0.0
    e = Electrode(
        charge=c.charge,
        current=0.0,
        peak_current=0.0,
        square=0.0,
        supplied=c.supplied,
        loss=lost(entry, moving, w, c.charge, c.supplied, c.loss, age),
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
            before = e.square
            e = charged(e, law, since, p.resistance, bound, v0, v1, v2, span)
            moment = moment + (e.square - before) * (start - t + 0.5 * span)
        piece_start = end
    ended = voltage(moving, e.charge, age + h)
    rate = voltage_rate(moving, ended, e.current, age + h)
    line = ended * ended - ended * rate * h
    coupled = c.coupled
    if w.value != 0.0:
        coupled = 1.0
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
        delivered=c.delivered + work_until(entry, mark),
        coupled=coupled,
        mark_square=mark.square,
        mark_power=mark.power,
        mark_power_rate=mark.power_rate,
        mark_span=h,
        mark_area=e.square,
        mark_moment=moment,
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
        top_delivered=top.delivered,
        top_coupled=top.coupled,
        top_mark_square=top.mark_square,
        top_mark_power=top.mark_power,
        top_mark_power_rate=top.mark_power_rate,
        top_mark_span=top.mark_span,
        top_mark_area=top.mark_area,
        top_mark_moment=top.mark_moment,
        bottom_drive=bottom.drive,
        bottom_charge=bottom.charge,
        bottom_voltage=bottom.voltage,
        bottom_voltage_rate=bottom.voltage_rate,
        bottom_square_curvature=bottom.square_curvature,
        bottom_current=bottom.current,
        bottom_peak_current=bottom.peak_current,
        bottom_supplied=bottom.supplied,
        bottom_loss=bottom.loss,
        bottom_delivered=bottom.delivered,
        bottom_coupled=bottom.coupled,
        bottom_mark_square=bottom.mark_square,
        bottom_mark_power=bottom.mark_power,
        bottom_mark_power_rate=bottom.mark_power_rate,
        bottom_mark_span=bottom.mark_span,
        bottom_mark_area=bottom.mark_area,
        bottom_mark_moment=bottom.mark_moment,
    )


def uncharged(p: Params, u: Input, side: float, t: float) -> Channel:
    """Channel at V = 0, its amplifier at 0 too."""
    charge = 0.0
    if not unconnected(u, side, 0.0):
        charge = charge_at(law_of(u, side), 0.0, law_age(u, side, t))
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
        delivered=0.0,
        coupled=0.0,
        mark_square=0.0,
        mark_power=0.0,
        mark_power_rate=0.0,
        mark_span=0.0,
        mark_area=0.0,
        mark_moment=0.0,
    )


def initial(p: Params, u: Input, t: float) -> State:
    """Both electrodes uncharged, the amplifier about to follow its command."""
    return joined(uncharged(p, u, 1.0, t), uncharged(p, u, -1.0, t))


def channel(x: State, side: float) -> Channel:
    """One channel of the state."""
    if side > 0.0:
        return Channel(
            drive=x.top_drive,
            charge=x.top_charge,
            voltage=x.top_voltage,
            voltage_rate=x.top_voltage_rate,
            square_curvature=x.top_square_curvature,
            current=x.top_current,
            peak_current=x.top_peak_current,
            supplied=x.top_supplied,
            loss=x.top_loss,
            delivered=x.top_delivered,
            coupled=x.top_coupled,
            mark_square=x.top_mark_square,
            mark_power=x.top_mark_power,
            mark_power_rate=x.top_mark_power_rate,
            mark_span=x.top_mark_span,
            mark_area=x.top_mark_area,
            mark_moment=x.top_mark_moment,
        )
    return Channel(
        drive=x.bottom_drive,
        charge=x.bottom_charge,
        voltage=x.bottom_voltage,
        voltage_rate=x.bottom_voltage_rate,
        square_curvature=x.bottom_square_curvature,
        current=x.bottom_current,
        peak_current=x.bottom_peak_current,
        supplied=x.bottom_supplied,
        loss=x.bottom_loss,
        delivered=x.bottom_delivered,
        coupled=x.bottom_coupled,
        mark_square=x.bottom_mark_square,
        mark_power=x.bottom_mark_power,
        mark_power_rate=x.bottom_mark_power_rate,
        mark_span=x.bottom_mark_span,
        mark_area=x.bottom_mark_area,
        mark_moment=x.bottom_mark_moment,
    )


def account_of(c: Channel) -> Account:
    """The account of a channel, as of its last communication point."""
    return Account(
        delivered=c.delivered,
        coupled=c.coupled,
        square=c.mark_square,
        power=c.mark_power,
        power_rate=c.mark_power_rate,
        span=c.mark_span,
        area=c.mark_area,
        moment=c.mark_moment,
    )


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """Both channels after `h` [s]."""
    return joined(
        advance_channel(p, u, 1.0, channel(x, 1.0), t, h),
        advance_channel(p, u, -1.0, channel(x, -1.0), t, h),
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
