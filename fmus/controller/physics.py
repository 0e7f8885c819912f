"""Digital controller of a flapping drive: it tracks resonance and holds a stroke.

The drive is a square wave of frequency f: the top channel is at V = V_max sqrt(d) over the first
half of a cycle, the bottom one over the second. The force of the film follows V^2, hence d. Once a
cycle, with the lag of the motion behind the drive and its stroke over that cycle,

    f = F + k_f (lag* - lag),      F <- F + k_F (lag* - lag),
    d = D + k_d (stroke* - stroke), D <- D + k_D (stroke* - stroke),

each within its limits, the sums too. At resonance the lag of the displacement is 90 degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .interface import Input as Input
from .interface import Output as Output
from .interface import Params as Params
from .sensing import Measure, Stroke, Sums, measured, sampled, stroke_of

EARLY = 1.0e-6
"""Share of a cycle by which an edge may come early, where a step ends just before it."""

MOVING = 1.0e-2
"""Stroke [rad] below which a lag tells nothing: the frequency stays."""

MOST_EDGES = 10000.0


@dataclass(frozen=True)
class State:
    """The half cycle that runs, the last measurement, sums of this cycle, results of the last."""

    edge_time: float
    period: float
    half: float
    drive: float
    frequency_sum: float
    drive_sum: float
    cycles: float
    lag: float
    stroke: float
    measure_time: float
    measure_value: float
    measure_rate: float
    measure_half: float
    sample: float
    taken: float
    sine: float
    cosine: float
    random: float


def sums_of(x: State) -> Sums:
    """The sums of the cycle that runs."""
    return Sums(
        sample=x.sample,
        taken=x.taken,
        sine=x.sine,
        cosine=x.cosine,
        random=x.random,
    )


def measure_of(x: State) -> Measure:
    """The last measurement."""
    return Measure(
        time=x.measure_time, value=x.measure_value, rate=x.measure_rate, half=x.measure_half
    )


def updated(x: State, m: Measure, s: Sums) -> State:
    """State with another measurement and other sums."""
    return State(
        edge_time=x.edge_time,
        period=x.period,
        half=x.half,
        drive=x.drive,
        frequency_sum=x.frequency_sum,
        drive_sum=x.drive_sum,
        cycles=x.cycles,
        lag=x.lag,
        stroke=x.stroke,
        measure_time=m.time,
        measure_value=m.value,
        measure_rate=m.rate,
        measure_half=m.half,
        sample=s.sample,
        taken=s.taken,
        sine=s.sine,
        cosine=s.cosine,
        random=s.random,
    )


def voltage(p: Params, drive: float) -> float:
    """Voltage [V] of a drive: the force follows its square."""
    return p.largest_voltage * math.sqrt(drive)


def within(value: float, least: float, most: float) -> float:
    """The value, not beyond its limits."""
    return max(least, min(most, value))


def cleared(x: Sums) -> Sums:
    """Sums of a cycle that begins; the noise goes on."""
    return Sums(
        sample=0.0,
        taken=0.0,
        sine=0.0,
        cosine=0.0,
        random=x.random,
    )


def switched(p: Params, u: Input, x: State) -> State:
    """State after the edge at `edge_time`; at the end of a cycle the loops are closed."""
    period = x.period
    drive = x.drive
    frequency_sum = x.frequency_sum
    drive_sum = x.drive_sum
    cycles = x.cycles
    seen = Stroke(lag=x.lag, size=x.stroke)
    sums = sums_of(x)
    half = 1.0
    if x.half > 0.5:
        half = 0.0
        cycles = cycles + 1.0
        if cycles > 0.5:
            seen = stroke_of(sums)
            aside = 0.0
            if seen.size > MOVING:
                aside = p.lag_target - seen.lag
            short = p.stroke_target - seen.size
            frequency_sum = within(
                frequency_sum + p.lag_integral_gain * aside, p.least_frequency, p.largest_frequency
            )
            drive_sum = within(drive_sum + p.stroke_integral_gain * short, 0.0, 1.0)
            frequency = frequency_sum + p.lag_gain * aside + u.excitation_frequency
            period = 1.0 / within(frequency, p.least_frequency, p.largest_frequency)
            drive = within(drive_sum + p.stroke_gain * short + u.excitation_drive, 0.0, 1.0)
        sums = cleared(sums)
    return State(
        edge_time=x.edge_time + 0.5 * period,
        period=period,
        half=half,
        drive=drive,
        frequency_sum=frequency_sum,
        drive_sum=drive_sum,
        cycles=cycles,
        lag=seen.lag,
        stroke=seen.size,
        measure_time=x.measure_time,
        measure_value=x.measure_value,
        measure_rate=x.measure_rate,
        measure_half=x.measure_half,
        sample=0.0,
        taken=sums.taken,
        sine=sums.sine,
        cosine=sums.cosine,
        random=sums.random,
    )


def initial(p: Params, u: Input, t: float) -> State:
    """The drive at its start phase; a cycle that has begun before is not judged."""
    if p.least_frequency > p.largest_frequency:
        raise ValueError("least_frequency is above largest_frequency")
    period = 1.0 / within(p.start_frequency, p.least_frequency, p.largest_frequency)
    turns = p.start_phase / (2.0 * math.pi) + t / period
    share = turns - float(math.floor(turns))
    half = 0.0
    if share >= 0.5:
        half = 1.0
    cycles = 0.0
    if share > 0.0:
        cycles = -1.0
    m = measured(p, u, half, voltage(p, p.start_drive), t)
    return State(
        edge_time=t + (0.5 * (half + 1.0) - share) * period,
        period=period,
        half=half,
        drive=p.start_drive,
        frequency_sum=1.0 / period,
        drive_sum=p.start_drive,
        cycles=cycles,
        lag=0.0,
        stroke=0.0,
        measure_time=m.time,
        measure_value=m.value,
        measure_rate=m.rate,
        measure_half=m.half,
        sample=0.0,
        taken=0.0,
        sine=0.0,
        cosine=0.0,
        random=float(math.floor(p.noise_seed)),
    )


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    """State after `h` [s]: samples up to the measurement on the input, and the edges on the way."""
    stop = t + h
    before = measure_of(x)
    now = measured(p, u, x.half, voltage(p, x.drive), stop)
    edges = 0.0
    y = updated(x, before, sums_of(x))
    while y.edge_time <= stop + EARLY * y.period:
        edges = edges + 1.0
        if edges > MOST_EDGES:
            raise ValueError("the communication step spans more than 10000 edges of the drive")
        span = 0.5 * y.period
        start = y.edge_time - span
        sums = sampled(p, sums_of(y), before, now, y.half, start, span, y.edge_time)
        y = switched(p, u, updated(y, before, sums))
    span = 0.5 * y.period
    start = y.edge_time - span
    sums = sampled(p, sums_of(y), before, now, y.half, start, span, min(now.time, stop))
    return updated(y, now, sums)


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    level = voltage(p, x.drive)
    top = level
    bottom = 0.0
    if x.half > 0.5:
        top = 0.0
        bottom = level
    return Output(
        command_top=top,
        command_bottom=bottom,
        frequency=1.0 / x.period,
        drive=x.drive,
        voltage=level,
        lag=x.lag,
        stroke=x.stroke,
        cycles=max(0.0, x.cycles),
        next_event_time=x.edge_time,
    )
