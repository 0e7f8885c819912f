"""The limited lag and the electrode against fine subdivision, closed forms and extremes."""

from __future__ import annotations

import math
import random

import pytest
from scipy.integrate import solve_ivp

from fmus.amplifier.electrode import Electrode, Law, charged, voltage
from fmus.amplifier.relaxation import limited, relaxed, weights

EMPTY = Electrode(charge=0.0, current=0.0, peak_current=0.0, square=0.0, supplied=0.0, loss=0.0)


@pytest.mark.parametrize("z", [1e-9, 1e-4, 0.00999, 0.01001, 0.5, 30.0, 1e9])
def test_weights_are_the_integrals_they_stand_for(z: float) -> None:
    fade, w0, w1, w2 = weights(z)
    assert fade == pytest.approx(math.exp(-z))
    assert relaxed(0.0, 1.0, 0.0, 0.0, 1.0, z) == pytest.approx(w0)
    for weight, power in ((w1, 1), (w2, 2)):
        solved = solve_ivp(
            lambda t, y, n=power: [t**n - z * y[0]] if z < 40 else [0.0],
            (0.0, 1.0), [0.0], rtol=1e-11, atol=1e-20,
        )  # fmt: skip
        if z < 40:
            assert weight == pytest.approx(z * solved.y[0, -1], rel=1e-6)
        else:
            assert weight == pytest.approx(1.0, rel=1e-6)


def random_case(seed: int) -> tuple[Law, float, float, float, tuple[float, float, float], float]:
    rng = random.Random(seed)
    resistance, capacitance = 10 ** rng.uniform(3, 7), 10 ** rng.uniform(-12, -6)
    span = resistance * capacitance * 10 ** rng.uniform(-2, 1.3)
    limit = rng.choice([1e30, 1e-3 * 10 ** rng.uniform(-2, 1)])
    slope = rng.uniform(-2000, 2000)
    law = Law(
        charge=capacitance * rng.uniform(0, 100),
        capacitance=capacitance,
        motional_current=rng.uniform(-1, 1) * capacitance * 100 / span,
        capacitance_rate=0.0,
        by_square=0.0,
        charge_curvature=rng.uniform(-1, 1) * capacitance * 30 / span / span,
        reference_voltage=rng.uniform(0, 100),
    )
    drive = (rng.uniform(-2000, 2000), slope / span, 0.2 * slope / span / span)
    return law, resistance, limit, span, drive, capacitance * rng.uniform(-1000, 1000)


@pytest.mark.parametrize("seed", range(80))
def test_one_span_equals_many_small_ones(seed: int) -> None:
    law, resistance, limit, span, (v0, v1, v2), charge = random_case(seed)
    start = Electrode(
        charge=charge, current=0.0, peak_current=0.0, square=0.0, supplied=0.0, loss=0.0
    )
    whole = charged(start, law, 0.0, resistance, limit, v0, v1, v2, span)
    pieces, count = start, 100
    for k in range(count):
        t, d = k * span / count, span / count
        pieces = charged(
            pieces, law, t, resistance, limit, v0 + v1 * t + v2 * t * t, v1 + 2 * v2 * t, v2, d
        )
    size = law.capacitance * 1e3
    assert whole.charge == pytest.approx(pieces.charge, abs=1e-9 * size)
    assert whole.square == pytest.approx(pieces.square, rel=1e-6, abs=1e-6 * 1e6 * span)
    assert whole.supplied == pytest.approx(pieces.supplied, rel=1e-6, abs=1e-5 * size * 1e3)
    assert whole.loss == pytest.approx(pieces.loss, rel=1e-6, abs=1e-5 * size * 1e3)


@pytest.mark.parametrize("resistance", [0.0, 1.0, 1e4, 1e7])
@pytest.mark.parametrize("capacitance", [1e-12, 1e-9, 1e-6])
@pytest.mark.parametrize("span", [1e-7, 1e-4, 1.0, 1e3])
def test_no_blow_up_and_energy_closes(resistance: float, capacitance: float, span: float) -> None:
    law = Law(
        charge=0.0,
        capacitance=capacitance,
        motional_current=0.0,
        capacitance_rate=0.0,
        by_square=0.0,
        charge_curvature=0.0,
        reference_voltage=0.0,
    )
    e = EMPTY
    for level in (2000.0, -500.0, 2000.0):
        e = charged(e, law, 0.0, resistance, 1e30, level, 0.0, 0.0, span)
        assert abs(voltage(law, e.charge, 0.0)) <= 2000.0 * (1 + 1e-12)
    stored = 0.5 * e.charge * e.charge / capacitance
    assert e.supplied == pytest.approx(stored + e.loss, rel=1e-9, abs=1e-20)


def test_an_ideal_jump_costs_half_of_what_it_takes() -> None:
    law = Law(
        charge=0.0,
        capacitance=1e-9,
        motional_current=0.0,
        capacitance_rate=0.0,
        by_square=0.0,
        charge_curvature=0.0,
        reference_voltage=0.0,
    )
    e = charged(EMPTY, law, 0.0, 0.0, 1e30, 1000.0, 0.0, 0.0, 1e-3)
    assert e.charge == pytest.approx(1e-6)
    assert e.loss == pytest.approx(0.5 * 1e-9 * 1e6, rel=1e-9)


def test_the_current_limit_holds_and_is_left_again() -> None:
    law = Law(
        charge=0.0,
        capacitance=1e-9,
        motional_current=0.0,
        capacitance_rate=0.0,
        by_square=0.0,
        charge_curvature=0.0,
        reference_voltage=0.0,
    )
    e = charged(EMPTY, law, 0.0, 1e4, 1e-3, 1000.0, 0.0, 0.0, 2e-3)
    assert e.peak_current == pytest.approx(1e-3)
    assert e.charge == pytest.approx(1e-6, rel=1e-9)


def test_a_slew_limit_is_a_ramp() -> None:
    assert limited(0.0, 1000.0, 0.0, 0.0, 1e-12, 1e5, 1e-3) == pytest.approx(100.0)
    assert limited(0.0, 1000.0, 0.0, 0.0, 1e-12, 1e5, 1.0) == pytest.approx(1000.0)
