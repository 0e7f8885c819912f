"""The double cone: scaling, laws, loss."""

from __future__ import annotations

import dataclasses
import math

import pytest

from fmus.membrane import loss, physics

BENCH = physics.Params(film=2.0, outer_radius=20e-3, spacer=30e-3, layers=1.0, loss_factor=0.0)


def at(p: physics.Params, **inputs: float) -> physics.Output:
    u = physics.Input(**inputs)
    return physics.observe(p, physics.initial(p, u, 0.0), u, 0.0)


def static_stroke(p: physics.Params, voltage: float) -> float:
    low, high = 0.0, 6e-3
    for _ in range(60):
        middle = 0.5 * (low + high)
        if at(p, top_voltage=voltage, motion_displacement=middle).force_value > 0.0:
            low = middle
        else:
            high = middle
    return low


def test_static_stroke_of_figure_3() -> None:
    """Zero to peak, one cone at 1920 V; 2.8 is the middle of what silicones have."""
    assert static_stroke(BENCH, 1920.0) == pytest.approx(2.023e-3, rel=1e-3)
    usual = dataclasses.replace(BENCH, permittivity=2.8)
    assert static_stroke(usual, 1920.0) == pytest.approx(2.192e-3, rel=1e-3)


def test_the_vehicle_stack() -> None:
    """331 N/m, 0.341 N blocked, 1.37 mm free at 2.8, as the feasibility study has it."""
    stack = physics.Params(permittivity=2.8, loss_factor=0.0)
    assert at(stack).force_stiffness == pytest.approx(331.0, rel=2e-3)
    assert at(stack, top_voltage=1920.0).force_value == pytest.approx(0.341, rel=1e-2)
    assert static_stroke(stack, 1920.0) == pytest.approx(1.37e-3, rel=1e-2)


@pytest.mark.parametrize("factor", [0.025, 2.0])
def test_thickness_modulus_and_layers_scale_out(factor: float) -> None:
    """The same groups give the same cone: V ~ T sqrt(mu)."""
    base = at(BENCH, top_voltage=1200.0, motion_displacement=1e-3)
    scaled = physics.Params(
        film=2.0, outer_radius=20e-3, spacer=30e-3, loss_factor=0.0,
        thickness=40e-6 * factor, layers=1.0 / factor,
    )  # fmt: skip
    other = at(scaled, top_voltage=1200.0 * factor, motion_displacement=1e-3)
    assert other.force_value == pytest.approx(base.force_value, rel=1e-9)
    assert other.top_charge * factor == pytest.approx(base.top_charge, rel=1e-9)


@pytest.mark.parametrize("voltage", [0.0, 900.0, 1900.0])
@pytest.mark.parametrize("x", [-5e-3, 0.0, 5e-3])
def test_law_members_are_derivatives(voltage: float, x: float) -> None:
    here = at(BENCH, top_voltage=voltage, bottom_voltage=500.0, motion_displacement=x)
    h, d = 1e-6, 0.5

    def near(dx: float, dv: float) -> physics.Output:
        return at(BENCH, top_voltage=voltage + dv, bottom_voltage=500.0, motion_displacement=x + dx)

    stiffness = -(near(h, 0).force_value - near(-h, 0).force_value) / (2 * h)
    capacitance = (near(0, d).top_charge - near(0, -d).top_charge) / (2 * d)
    assert here.force_stiffness == pytest.approx(stiffness, rel=1e-5)
    assert here.top_capacitance == pytest.approx(capacitance, rel=1e-5)
    moving = at(
        BENCH, top_voltage=voltage, bottom_voltage=500.0, motion_displacement=x,
        motion_velocity=0.1,
    )  # fmt: skip
    slope = (near(h, 0).top_charge - near(-h, 0).top_charge) / (2 * h)
    assert moving.top_motional_current == pytest.approx(0.1 * slope, rel=1e-5, abs=1e-12)


@pytest.mark.parametrize("frequency", [1.0, 3.0, 10.0, 30.0, 52.0, 100.0])
def test_the_loss_factor_grows_as_it_should(frequency: float) -> None:
    """Loss per cycle of a sine over pi K X^2 is eta (f/52)^0.35, within 2 %."""
    omega, count = 2 * math.pi * frequency, 64
    b = loss.Branches(u0=0.0, u1=0.0, u2=0.0, u3=0.0, loss=0.0)
    h = 1.0 / frequency / count
    marks = []
    for k in range(count * 12):
        v0, vm, v1 = (omega * math.cos(omega * (k + s) * h) for s in (0.0, 0.5, 1.0))
        if k % count == 0:
            marks.append(b.loss)
        b = loss.moved(b, v0, vm, v1, h)
    cycle = marks[-1] - marks[-2]
    assert cycle / math.pi == pytest.approx((frequency / 52.0) ** 0.35, rel=0.025)


@pytest.mark.parametrize("h", [1e-6, 1e-3, 1.0, 1e3])
def test_branches_are_stable_at_any_step(h: float) -> None:
    b = loss.Branches(u0=1.0, u1=1.0, u2=1.0, u3=1.0, loss=0.0)
    for _ in range(20):
        b = loss.moved(b, 0.0, 0.0, 0.0, h)
        assert max(abs(b.u0), abs(b.u1), abs(b.u2), abs(b.u3)) <= 1.0
        assert b.loss >= 0.0


def test_one_step_of_the_branches_equals_many() -> None:
    start = loss.Branches(u0=1e-3, u1=-1e-3, u2=2e-3, u3=0.0, loss=0.0)
    h = 2e-3
    one = loss.moved(start, 0.1, 0.15, 0.2, h)
    many = start
    for k in range(200):
        v = [0.1 + 0.1 * (k + s) / 200 for s in (0.0, 0.5, 1.0)]
        many = loss.moved(many, *v, h / 200)
    for name in ("u0", "u1", "u2", "u3"):
        assert getattr(one, name) == pytest.approx(getattr(many, name), rel=1e-6, abs=1e-9)
    assert one.loss == pytest.approx(many.loss, rel=0.1)


@pytest.mark.parametrize(
    "inputs",
    [
        {"top_voltage": 2600.0},
        {"motion_displacement": 15e-3},
        {"motion_displacement": -40e-3},
        {"bottom_voltage": -2300.0},
    ],
)
def test_past_the_limits_it_refuses(inputs: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="membrane's table"):
        at(BENCH, **inputs)


@pytest.mark.parametrize("permittivity", [1.0, 100.0])
def test_permittivity_one_and_a_hundred(permittivity: float) -> None:
    p = physics.Params(permittivity=permittivity, loss_factor=0.0)
    if permittivity > 10.0:
        with pytest.raises(ValueError, match="pull-in"):
            at(p, top_voltage=1920.0)
    else:
        assert 0.0 < at(p, top_voltage=1920.0).force_value < 0.2
