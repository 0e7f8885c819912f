"""The payload is exact at any step."""

from __future__ import annotations

import math

import pytest

from fmus.payload import physics


def law(**changes: float) -> physics.Input:
    return physics.Input(**changes)


@pytest.mark.parametrize("stiffness", [0.0, 63.5, 6.35e6])
@pytest.mark.parametrize("damping", [0.0, 0.06, 60.0])
@pytest.mark.parametrize("mass", [1e-6, 0.603e-3, 1.0])
def test_one_step_equals_a_thousand(stiffness: float, damping: float, mass: float) -> None:
    p = physics.Params(mass=mass, start_displacement=1e-3, gravity=9.81)
    u = law(
        force_value=0.05,
        force_stiffness=stiffness,
        force_damping=damping,
        force_rate=3.0,
        force_curvature=-50.0,
        force_reference_displacement=1e-4,
        force_reference_velocity=0.01,
        force_reference_time=2e-3,
    )
    x = physics.initial(p, u, 0.0)
    h = 1e-3
    one = physics.advance(p, x, u, 0.0, h)
    for k in range(1000):
        x = physics.advance(p, x, u, k * h / 1000, h / 1000)
    assert one.displacement == pytest.approx(x.displacement, rel=1e-9, abs=1e-12)
    assert one.velocity == pytest.approx(x.velocity, rel=1e-8, abs=1e-9)
    assert one.force_work == pytest.approx(x.force_work, rel=1e-7, abs=1e-12)


def test_free_fall() -> None:
    p = physics.Params(gravity=9.81)
    x = physics.advance(p, physics.initial(p, law(), 0.0), law(), 0.0, 0.5)
    assert x.displacement == pytest.approx(-0.5 * 9.81 * 0.25)
    assert x.force_work == pytest.approx(0.0, abs=1e-12)


def test_energy_of_an_undamped_oscillator_after_ten_thousand_cycles() -> None:
    p = physics.Params(start_displacement=1e-3)
    u = law(force_stiffness=63.5)
    x = physics.initial(p, u, 0.0)
    h = 2 * math.pi * math.sqrt(p.mass / 63.5)
    for k in range(10_000):
        x = physics.advance(p, x, u, k * h, h)
    assert x.displacement == pytest.approx(1e-3, rel=1e-9)


def test_a_law_that_is_too_stiff_is_refused() -> None:
    p = physics.Params()
    with pytest.raises(ValueError, match="too stiff"):
        physics.advance(p, physics.initial(p, law(), 0.0), law(force_stiffness=1e20), 0.0, 1.0)
