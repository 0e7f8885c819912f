"""The load's derivatives, equation 6 and the stroke it sees."""

from __future__ import annotations

import math

import pytest

from fmus.aero import physics

P = physics.Params()


@pytest.mark.parametrize("rate", [-90.0, -30.0, -3.0, 0.0, 3.0, 30.0, 90.0])
def test_slopes_are_those_of_the_coefficients(rate: float) -> None:
    h = 1e-4
    for law in (physics.drag_law, physics.inertia_law):
        low, here, high = (law(P, rate + s * h) for s in (-1, 0, 1))
        assert (high[0] - low[0]) / (2 * h) == pytest.approx(here[1], rel=1e-5, abs=1e-16)


def test_equation_six_needs_a_lift_coefficient_of_2_056() -> None:
    mass = physics.hover_mass(P, math.radians(63.0), 18.0)
    assert mass == pytest.approx(133e-6, rel=1e-3)
    assert mass / P.hover_lift_coefficient == pytest.approx(64.68e-6, rel=1e-3)


def test_quasi_steady_lift_at_18_hz() -> None:
    """105 mg from the feasibility study: 63 degrees, sinusoidal."""
    amplitude, omega, count = math.radians(31.5), 2 * math.pi * 18.0, 2000
    rates = [amplitude * omega * math.cos(2 * math.pi * k / count) for k in range(count)]
    mean = sum(physics.lift(P, rate) for rate in rates) / count
    assert mean / physics.STANDARD_GRAVITY == pytest.approx(105e-6, rel=0.02)


def test_without_feathering_there_is_no_lift() -> None:
    assert physics.lift(physics.Params(feathering_angle=0.0), 60.0) == 0.0


def test_stroke_and_frequency_are_seen() -> None:
    x = physics.initial(P, physics.Input(), 0.0)
    h, amplitude, omega = 1e-3, 0.5, 2 * math.pi * 18.0
    for k in range(300):
        t = k * h
        u = physics.Input(
            motion_flap_angle=amplitude * math.sin(omega * t),
            motion_flap_rate=amplitude * omega * math.cos(omega * t),
            motion_reference_time=t,
        )
        x = physics.advance(P, x, u, t, h)
    seen = physics.observe(P, x, u, 300 * h)
    assert seen.stroke == pytest.approx(1.0, rel=1e-3)
    assert seen.frequency == pytest.approx(18.0, rel=1e-3)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_what_is_left_of_the_membrane_carries_its_share(share: float) -> None:
    p = physics.Params(membrane_share=share)
    for law in (physics.drag_law, physics.inertia_law):
        whole, left = law(P, 40.0), law(p, 40.0)
        assert left == pytest.approx((share * whole[0], share * whole[1]), rel=1e-12)
    assert physics.lift(p, 40.0) == pytest.approx(share * physics.lift(P, 40.0), rel=1e-12)
