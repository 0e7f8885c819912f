"""Outputs of the record, made by the build from its columns; nothing to edit."""

from __future__ import annotations

from dataclasses import dataclass

from ..quantity import provided
from .interpolation import edge, place, slope, square_curvature, value


@dataclass(frozen=True)
class Output:
    """Columns of the record, and members of laws that follow from them."""

    top_voltage: float = provided(
        "V",
        "Recorded: top.voltage [V]",
        name="top.voltage",
        port="top",
        order=0,
    )
    bottom_voltage: float = provided(
        "V",
        "Recorded: bottom.voltage [V]",
        name="bottom.voltage",
        port="bottom",
        order=0,
    )
    top_voltage_rate: float = provided(
        "V/s",
        "Rate of the recorded voltage",
        name="top.voltage_rate",
        port="top",
        order=1,
    )
    top_square_curvature: float = provided(
        "V2/s2",
        "Coefficient of s^2 in the square",
        name="top.square_curvature",
        port="top",
        order=2,
    )
    top_voltage_time: float = provided(
        "s",
        "Time at which the voltage holds",
        name="top.voltage_time",
        port="top",
        order=1,
    )
    bottom_voltage_rate: float = provided(
        "V/s",
        "Rate of the recorded voltage",
        name="bottom.voltage_rate",
        port="bottom",
        order=1,
    )
    bottom_square_curvature: float = provided(
        "V2/s2",
        "Coefficient of s^2 in the square",
        name="bottom.square_curvature",
        port="bottom",
        order=2,
    )
    bottom_voltage_time: float = provided(
        "s",
        "Time at which the voltage holds",
        name="bottom.voltage_time",
        port="bottom",
        order=1,
    )


def outputs_at(time: float, offset: float, size: float, before: float, after: float) -> Output:
    """Outputs at a time, at the end of a step of this size [s]; 0 for none yet."""
    here = place(time - offset)
    start = place(time - offset - size)
    side = edge(time - offset, size)
    top_voltage = value(0, here, before, after)
    bottom_voltage = value(1, here, before, after)
    top_voltage_rate = slope(0, side)
    top_square_curvature = square_curvature(0, slope(0, side), start, here, size, before, after)
    top_voltage_time = time
    bottom_voltage_rate = slope(1, side)
    bottom_square_curvature = square_curvature(1, slope(1, side), start, here, size, before, after)
    bottom_voltage_time = time
    return Output(
        top_voltage=top_voltage,
        bottom_voltage=bottom_voltage,
        top_voltage_rate=top_voltage_rate,
        top_square_curvature=top_square_curvature,
        top_voltage_time=top_voltage_time,
        bottom_voltage_rate=bottom_voltage_rate,
        bottom_square_curvature=bottom_square_curvature,
        bottom_voltage_time=bottom_voltage_time,
    )
