"""Equation of motion, stops and energies of the linkage."""

from __future__ import annotations

import math

import pytest

from fmus.linkage import physics
from fmus.linkage.physics import slider_acceleration


@pytest.mark.parametrize("joint", [-0.9, -0.3, 0.0, 0.3, 0.9])
@pytest.mark.parametrize("applied", [-2.0, -0.1, 0.0, 0.1, 2.0])
@pytest.mark.parametrize("bias", [-1.0, 0.0, 1.0])
def test_friction_with_load_is_solved_exactly(joint: float, applied: float, bias: float) -> None:
    mass, wing, coulomb = 7e-3, 2e-2, 0.01
    a = slider_acceleration(mass, applied, coulomb, joint, wing, bias)
    load = wing * a + bias
    assert mass * a == pytest.approx(applied - coulomb - joint * abs(load) - load, abs=1e-12)


def energy(p: physics.Params, x: physics.State) -> float:
    rate = x.slope * x.velocity
    return 0.5 * p.slider_mass * x.velocity**2 + 0.5 * p.wing_inertia * rate**2


@pytest.mark.parametrize("stiffness", [1e6, 1e8, 1e10])
def test_hard_stops_at_three_times_the_drive_close_the_energy(stiffness: float) -> None:
    p = physics.Params(stop_stiffness=stiffness, wing_inertia=8.2e-8, damping=0.1654)
    x = physics.initial(p, physics.Input(), 0.0)
    h = 1.0 / 18.0 / 100
    furthest = 0.0
    for k in range(400):
        force = 0.9 if (k // 50) % 2 == 0 else -0.9
        x = physics.advance(p, x, physics.Input(force_value=force), k * h, h)
        furthest = max(furthest, abs(x.displacement))
    lost = x.viscous_loss + x.friction_loss + x.stop_loss
    stored = energy(p, x) + physics.stop_energy(p, x.displacement)
    assert furthest > p.stop_travel
    assert x.force_work == pytest.approx(stored + lost, rel=2e-3)
    assert min(x.viscous_loss, x.friction_loss, x.stop_loss) > 0.0


def test_without_loss_the_energy_stays_for_a_thousand_cycles() -> None:
    p = physics.Params(
        joint_friction=0.0, coulomb_friction=0.0, start_displacement=1e-3, resolution=0.05
    )
    u = physics.Input(force_stiffness=331.0)
    x = physics.initial(p, u, 0.0)
    begin = 0.5 * 331.0 * x.displacement**2
    period = 2 * math.pi * math.sqrt(p.slider_mass / 331.0)
    for k in range(4000):
        x = physics.advance(p, x, u, k * 0.25 * period, 0.25 * period)
    assert energy(p, x) + 0.5 * 331.0 * x.displacement**2 == pytest.approx(begin, rel=1e-3)


@pytest.mark.parametrize("density", [1.0, 833.0, 1e4])
@pytest.mark.parametrize("inertia", [0.0, 8e-8])
def test_any_load_coefficient_is_bounded(density: float, inertia: float) -> None:
    """Water and massless wings: the load is a coefficient, never an acceleration."""
    p = physics.Params(wing_inertia=inertia)
    u = physics.Input(
        force_value=0.1,
        load_quadratic_drag=1e-8 * density,
        load_added_inertia=6e-9 * density,
    )
    x = physics.initial(p, u, 0.0)
    for k in range(50):
        x = physics.advance(p, x, u, k * 1e-3, 1e-3)
    assert abs(x.displacement) < 2.2e-3


def test_the_substep_count_is_bounded() -> None:
    p = physics.Params()
    u = physics.Input(force_stiffness=1e22)
    with pytest.raises(ValueError, match="too stiff"):
        physics.advance(p, physics.initial(p, u, 0.0), u, 0.0, 1e-2)


def test_what_leaves_in_flight_takes_its_energy_with_it() -> None:
    """The motion goes on as it was; the counters of work and loss know nothing of the part lost."""
    before = physics.Params(wing_inertia=8e-8, coulomb_friction=0.0, joint_friction=0.0)
    after = physics.Params(wing_inertia=3e-8, coulomb_friction=0.0, joint_friction=0.0)
    u = physics.Input(force_value=0.05)
    x = physics.advance(before, physics.initial(before, u, 0.0), u, 0.0, 5e-3)
    rate = x.slope * x.velocity
    kept = physics.observe(after, x, u, 5e-3).kinetic_energy
    had = physics.observe(before, x, u, 5e-3).kinetic_energy
    assert had - kept == pytest.approx(0.5 * 5e-8 * rate * rate, rel=1e-9)
    y = physics.advance(after, x, u, 5e-3, 2e-3)
    gained = energy(after, y) - kept
    assert y.force_work - x.force_work == pytest.approx(gained, rel=1e-4)
