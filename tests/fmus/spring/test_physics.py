"""Reciprocity, the law itself, and the loss that it keeps account of."""

from __future__ import annotations

import math

import pytest

from fmus.spring import physics

P = physics.Params()


def at(x: float, top: float, bottom: float = 0.0, v: float = 0.0) -> physics.Output:
    u = physics.Input(
        motion_displacement=x, motion_velocity=v, top_voltage=top, bottom_voltage=bottom
    )
    return physics.observe(P, physics.initial(P, u, 0.0), u, 0.0)


def test_force_and_charge_come_from_one_co_energy() -> None:
    """dF/d(V^2) = 1/2 dC/dx: what the electrical side puts in, the mechanical side takes out."""
    x, h, top = 1e-3, 1e-6, 1500.0
    force_slope = (at(x, top + 1.0).force_value - at(x, top - 1.0).force_value) / (4.0 * top)
    slope = (at(x + h, top).top_capacitance - at(x - h, top).top_capacitance) / (2 * h)
    assert force_slope == pytest.approx(0.5 * slope, rel=1e-6)


def test_the_law_is_the_force_nearby() -> None:
    u = physics.Input(
        top_voltage=1000.0,
        top_voltage_rate=2e5,
        top_square_curvature=1e9,
        top_voltage_time=1.0,
        motion_displacement=5e-4,
        motion_velocity=0.1,
        motion_reference_time=1.0,
    )
    x = physics.initial(P, u, 1.0)
    law = physics.observe(P, x, u, 1.0)
    later = physics.observe(P, x, u, 1.001)
    s = 1e-3
    predicted = (
        law.force_value
        - law.force_stiffness * (later.force_reference_displacement - 5e-4)
        + law.force_rate * s
        + law.force_curvature * s * s
    )
    assert later.force_value == pytest.approx(predicted, rel=1e-10)


def test_the_loss_is_that_of_the_motion() -> None:
    """x = X sin(w t) loses pi c w X^2 per cycle."""
    amplitude, omega, count = 1e-3, 2 * math.pi * 50.0, 40
    x = physics.initial(P, physics.Input(motion_velocity=amplitude * omega), 0.0)
    h = 1.0 / 50.0 / count
    for k in range(count + 1):
        u = physics.Input(
            motion_displacement=amplitude * math.sin(omega * k * h),
            motion_velocity=amplitude * omega * math.cos(omega * k * h),
            motion_reference_time=k * h,
        )
        lost = physics.observe(P, x, u, k * h).dissipated_energy
        x = physics.advance(P, x, u, k * h, h)
    expected = math.pi * physics.damping(P) * omega * amplitude**2
    assert lost == pytest.approx(expected, rel=1e-5)


def test_a_loss_factor_is_the_damping_that_has_it() -> None:
    p = physics.Params(damping=0.0, loss_factor=0.25, loss_frequency=52.0)
    expected = 0.25 * p.stiffness / (2 * math.pi * 52.0)
    assert physics.damping(p) == pytest.approx(expected)


def test_displacement_beyond_the_capacitance_is_refused() -> None:
    with pytest.raises(ValueError, match="no capacitance left"):
        at(-0.1, 100.0)
