"""Function generator: what each channel puts out, and where it jumps."""

from __future__ import annotations

import math

from ..quantity import UNLIMITED

CHOICES = (
    "constant",
    "sine",
    "raised_sine",
    "half_wave_sine",
    "square",
    "triangle",
    "external",
)
CONSTANT = 1.0
SINE = 2.0
RAISED_SINE = 3.0
HALF_WAVE_SINE = 4.0
SQUARE = 5.0
TRIANGLE = 6.0
EXTERNAL = 7.0

COINCIDENT = 1.0e-9
"""Distance in cycles below which an edge counts as reached."""


def shape(waveform: float, cycles: float, inside: float) -> float:
    """Waveform of unit amplitude at a phase in cycles.

    Sine is bipolar; all others lie between 0 and 1, since the force follows V^2 and two
    bipolar waves half a cycle apart pull equally. `inside` is the phase of a point within
    the same smooth piece: it decides on which side of an edge the square wave stands.
    """
    if waveform == CONSTANT:
        return 1.0
    if waveform == SQUARE:
        if inside - math.floor(inside) < 0.5:
            return 1.0
        return 0.0
    if waveform == TRIANGLE:
        shifted = cycles + 0.25
        return 1.0 - math.fabs(2.0 * (shifted - math.floor(shifted)) - 1.0)
    sine = math.sin(2.0 * math.pi * cycles)
    if waveform == RAISED_SINE:
        return 0.5 * (1.0 + sine)
    if waveform == HALF_WAVE_SINE:
        return max(0.0, sine)
    return sine


def envelope(soft_start: float, time: float) -> float:
    """Smooth rise 3 r^2 - 2 r^3 from 0 to 1 over `soft_start` [s]; 1 where that is zero."""
    if time >= soft_start:
        return 1.0
    ratio = max(0.0, time / soft_start)
    return ratio * ratio * (3.0 - 2.0 * ratio)


def edges_per_cycle(waveform: float) -> float:
    """How often per cycle value or slope jumps: twice, or never."""
    if waveform == SQUARE or waveform == HALF_WAVE_SINE or waveform == TRIANGLE:
        return 2.0
    return 0.0


def next_edge(waveform: float, frequency: float, phase: float, time: float) -> float:
    """Time [s] of the first jump in value or slope after `time`; `UNLIMITED` without one.

    Square and half-wave jump at multiples of half a cycle, the triangle a quarter later.
    `phase` is in cycles. An edge within 1e-9 cycles of `time` counts as passed.
    """
    if edges_per_cycle(waveform) == 0.0 or frequency <= 0.0:
        return UNLIMITED
    offset = phase
    if waveform == TRIANGLE:
        offset = phase + 0.25
    halves = math.floor(2.0 * (frequency * time + offset + COINCIDENT)) + 1.0
    return (0.5 * halves - offset) / frequency


def piece_end(waveform: float, frequency: float, phase: float, time: float, stop: float) -> float:
    """End [s] of the smooth piece that starts at `time`: the next edge, but at most `stop`.

    An edge within 1e-9 cycles of `stop` belongs to what comes after: a step that ends on an
    edge must hand over the values before it.
    """
    edge = next_edge(waveform, frequency, phase, time)
    if (stop - edge) * frequency <= COINCIDENT:
        return stop
    return edge
