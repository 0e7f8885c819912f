"""Waveforms, edges and the voltage law of the amplifier."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace
from itertools import pairwise

import pytest

from fmus.amplifier import physics
from fmus.amplifier.waveform import CHOICES, next_edge, shape
from fmus.law import elapsed
from fmus.quantity import NO_REFERENCE

INPUT = physics.Input()


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("constant", (1.0, 1.0, 1.0, 1.0)),
        ("sine", (0.0, 1.0, 0.0, -1.0)),
        ("raised_sine", (0.5, 1.0, 0.5, 0.0)),
        ("half_wave_sine", (0.0, 1.0, 0.0, 0.0)),
        ("square", (1.0, 1.0, 0.0, 0.0)),
        ("triangle", (0.5, 1.0, 0.5, 0.0)),
    ],
)
def test_shapes_at_the_quarters(name: str, values: tuple[float, ...]) -> None:
    code = float(CHOICES.index(name) + 1)
    for quarter, value in enumerate(values):
        assert shape(code, 0.25 * quarter, 0.25 * quarter) == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize("frequency", [0.01, 18.0, 2000.0])
@pytest.mark.parametrize("phase", [0.0, 0.5, 0.123])
def test_edges_come_twice_a_cycle_and_never_twice(frequency: float, phase: float) -> None:
    time = 0.0
    edges = []
    for _ in range(2000):
        time = next_edge(5.0, frequency, phase, time)
        edges.append(time)
    gaps = [b - a for a, b in pairwise(edges)]
    assert min(gaps) == pytest.approx(0.5 / frequency, rel=1e-6)
    assert max(gaps) == pytest.approx(0.5 / frequency, rel=1e-6)


def test_a_step_that_ends_on_an_edge_hands_over_what_was_before() -> None:
    """One ulp past the edge must not let the inrush of the next level into V'."""
    p = physics.Params(frequency=18.0, resistance=100.0)
    x = physics.initial(p, INPUT, 0.0)
    h = 1.0 / 36.0
    for step in (h, math.nextafter(h, 1.0), h * (1 + 1e-12)):
        after = physics.advance(p, x, INPUT, 0.0, step)
        assert abs(after.top_voltage_rate) < 1.0
        assert after.top_voltage == pytest.approx(1920.0)


@pytest.mark.parametrize("waveform", range(1, 7))
@pytest.mark.parametrize("resistance", [0.0, 1e5, 1e7])
def test_the_law_has_the_mean_square_of_the_true_voltage(waveform: int, resistance: float) -> None:
    """V^2 + 2 V V' s + k s^2 over the step just taken has the mean of many small steps."""
    p = physics.Params(waveform=float(waveform), resistance=resistance, frequency=30.0)
    x = physics.initial(p, INPUT, 0.0)
    h, count = 4e-3, 400
    t = 0.0
    for _ in range(5):
        coarse = physics.advance(p, x, INPUT, t, h)
        fine, total = x, 0.0
        for k in range(count):
            d = h / count
            fine = physics.advance(p, fine, INPUT, t + k * d, d)
            v, r, c = fine.top_voltage, fine.top_voltage_rate, fine.top_square_curvature
            total += (v * v - v * r * d + c * d * d / 3.0) * d
        v, r, c = coarse.top_voltage, coarse.top_voltage_rate, coarse.top_square_curvature
        mean = v * v - v * r * h + c * h * h / 3.0
        assert mean == pytest.approx(total / h, rel=1e-4, abs=1.0)
        assert coarse.top_charge == pytest.approx(fine.top_charge, rel=1e-5, abs=1e-12)
        x, t = coarse, t + h


@pytest.mark.parametrize("capacitance", [1e-12, 3.24e-9, 1e-6])
@pytest.mark.parametrize("resistance", [0.0, 1e5, 1e7])
@pytest.mark.parametrize("step", [1e-8, 1e-4, 0.03, 7.0])
def test_any_step_is_bounded(capacitance: float, resistance: float, step: float) -> None:
    u = physics.Input(top_capacitance=capacitance, bottom_capacitance=capacitance)
    p = physics.Params(resistance=resistance)
    x = physics.initial(p, u, 0.0)
    for k in range(6):
        x = physics.advance(p, x, u, k * step, step)
        assert -1e-6 <= x.top_voltage <= 1920.0 * (1 + 1e-9)
        assert -1e-6 <= x.bottom_voltage <= 1920.0 * (1 + 1e-9)


@pytest.mark.parametrize("limit", ["current_limit", "power_limit", "slew_rate", "bandwidth"])
def test_each_limit_slows_the_rise(limit: str) -> None:
    value = {"current_limit": 1e-3, "power_limit": 1.0, "slew_rate": 1e5, "bandwidth": 50.0}[limit]
    free = physics.Params(resistance=1e3, frequency=5.0)
    bound = physics.Params(resistance=1e3, frequency=5.0, **{limit: value})
    u = INPUT
    fast = physics.advance(free, physics.initial(free, u, 0.0), u, 0.0, 2e-3)
    slow = physics.advance(bound, physics.initial(bound, u, 0.0), u, 0.0, 2e-3)
    assert fast.top_voltage == pytest.approx(1920.0)
    assert 0.0 < slow.top_voltage < 0.9 * 1920.0


def test_the_power_limit_takes_the_time_that_the_energy_needs() -> None:
    """C V^2/2 = 6 mJ at 1 W takes 6 ms."""
    p = physics.Params(resistance=0.0, power_limit=1.0, waveform=1.0)
    x = physics.initial(p, INPUT, 0.0)
    time, h = 0.0, 1e-4
    while x.top_voltage < 1919.0:
        x = physics.advance(p, x, INPUT, time, h)
        time += h
    assert time == pytest.approx(0.5 * 3.24e-9 * 1920.0**2, rel=0.03)


def test_a_channel_without_capacitance_is_refused() -> None:
    with pytest.raises(ValueError, match="capacitance is not positive"):
        physics.advance(
            physics.Params(),
            physics.initial(physics.Params(), INPUT, 0.0),
            physics.Input(top_capacitance=-1e-12),
            0.0,
            1e-4,
        )


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    "name",
    ["charge", "capacitance", "motional_current", "capacitance_rate", "capacitance_by_square",
     "charge_curvature"],
)  # fmt: skip
def test_a_law_beyond_all_measure_is_refused_or_solved_at_once(name: str, sign: float) -> None:
    """Neither an endless loop nor a result that is no number."""
    sound = {"top_capacitance": 3e-9, "bottom_capacitance": 3e-9, f"top_{name}": sign * 1e300}
    p, u = physics.Params(), physics.Input(**sound)
    x = physics.initial(p, INPUT, 0.0)
    with contextlib.suppress(ValueError):
        after = physics.advance(p, x, u, 0.0, 1e-3)
        assert not math.isnan(after.top_voltage)


def test_an_electrode_that_nothing_is_connected_to_waits() -> None:
    """Other masters leave inputs at zero until the first exchange."""
    empty = replace(INPUT, top_capacitance=0.0, bottom_capacitance=0.0)
    p = physics.Params()
    start = physics.initial(p, empty, 0.0)
    waited = physics.advance(p, start, empty, 0.0, 1e-3)
    assert (waited.top_voltage, waited.top_charge, waited.top_supplied) == (0.0, 0.0, 0.0)
    charged = physics.advance(p, waited, INPUT, 1e-3, 1e-3)
    assert charged.top_charge > 1e-6
    with pytest.raises(ValueError, match="capacitance is not positive"):
        physics.advance(p, charged, empty, 2e-3, 1e-3)
    with pytest.raises(ValueError, match="capacitance is not positive"):
        physics.initial(p, replace(empty, top_capacitance=-1e-9), 0.0)


def test_a_reference_time_of_zero_is_none() -> None:
    assert elapsed(3.0, 0.0) == 0.0
    assert elapsed(3.0, NO_REFERENCE) == 0.0
    assert elapsed(3.0, 2.5) == 0.5
