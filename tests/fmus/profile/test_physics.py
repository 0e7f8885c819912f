"""Shapes of the cones against the membrane's own numbers."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator

from fmus.constants import VACUUM_PERMITTIVITY
from fmus.membrane import physics as membrane
from fmus.membrane.tables import described
from fmus.profile import physics
from fmus.profile.tables import COUNT, FILMS, LOADING, LOWEST, MATERIALS, PLACES

BENCH = {"film": 2.0, "outer_radius": 20e-3, "spacer": 30e-3}
INNER = 4e-3
EVERY = described(MATERIALS.read_text(encoding="utf-8"))

Values = NDArray[np.float64]


def at(p: physics.Params, **inputs: float) -> physics.Output:
    u = physics.Input(**inputs)
    return physics.observe(p, physics.initial(p, u, 0.0), u, 0.0)


def points(found: physics.Output, cone: str) -> tuple[Values, Values]:
    told = dataclasses.asdict(found)
    ways = ("radius", "axial")
    r, z = ([told[f"{cone}_shape_{way}_{k + 1}"] for k in range(COUNT)] for way in ways)
    return np.array(r), np.array(z)


@pytest.mark.parametrize("voltage", [0.0, 1000.0, 1700.0])
@pytest.mark.parametrize("x", [-4e-3, 0.0, 3e-3])
def test_the_shape_has_the_capacitance_of_the_membrane(voltage: float, x: float) -> None:
    """C = (2 pi eps/T) int l1^2 l2^2 R dR over the polynomial through points and rims."""
    p = physics.Params(**BENCH)
    r, z = points(at(p, top_voltage=voltage, motion_displacement=x), "top")
    s = np.array([0.0, *PLACES, 1.0])
    stretch = math.log(p.outer_radius / INNER)
    radius = BarycentricInterpolator(s, np.array([INNER, *r, p.outer_radius]))
    height = BarycentricInterpolator(s, np.array([0.5 * p.spacer + x, *z, 0.0]))
    nodes, weights = np.polynomial.legendre.leggauss(40)
    at_s, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    flat = INNER * np.exp(stretch * at_s)
    slope = np.hypot(radius.derivative(at_s), height.derivative(at_s)) / (stretch * flat)
    integral = weights @ (slope**2 * (radius(at_s) / flat) ** 2 * flat**2 * stretch)
    permittivity = VACUUM_PERMITTIVITY * p.permittivity
    q = membrane.Params(**BENCH, layers=1.0, loss_factor=0.0)
    u = membrane.Input(top_voltage=voltage, motion_displacement=x)
    charge = membrane.observe(q, membrane.initial(q, u, 0.0), u, 0.0)
    wanted = charge.top_charge / voltage if voltage else charge.top_capacitance
    assert 2.0 * math.pi * permittivity / p.thickness * integral == pytest.approx(wanted, rel=2e-3)


def test_cones_mirror_each_other() -> None:
    p = physics.Params(**BENCH)
    one = at(p, top_voltage=1200.0, bottom_voltage=300.0, motion_displacement=2e-3)
    other = at(p, top_voltage=300.0, bottom_voltage=1200.0, motion_displacement=-2e-3)
    for way, sign in ((0, 1.0), (1, -1.0)):
        assert points(one, "top")[way] == pytest.approx(sign * points(other, "bottom")[way])


@pytest.mark.parametrize("film", range(len(FILMS)))
def test_voltage_widens_a_cone_and_points_keep_their_order(film: int) -> None:
    """The film grows between its rims: it bulges outwards, and no point overtakes another."""
    data, _ = EVERY[film]
    b = data["outer_radius"]
    p = physics.Params(
        film=film + 1.0, outer_radius=b, spacer=1.4 * b, thickness=data["thickness"],
        modulus=data["moduli"][0], permittivity=data["permittivity"],
    )  # fmt: skip
    passive, active = (points(at(p, top_voltage=v), "top") for v in (0.0, 0.9 * data["voltage"]))
    assert np.all(active[0] > passive[0])
    for r, z in (passive, active):
        assert np.all(np.diff(r) > 0.0)
        assert np.all(np.diff(z) < 0.0)


def test_below_the_table_the_profile_flattens() -> None:
    p = dataclasses.replace(physics.Params(**BENCH), spacer=14e-3)
    low = LOWEST[1] * p.outer_radius
    r0, z0 = points(at(p, motion_displacement=low - 0.5 * p.spacer), "top")
    r, z = points(at(p, motion_displacement=0.5 * (low - p.spacer)), "top")
    assert r == pytest.approx(r0)
    assert z == pytest.approx(0.5 * z0)
    assert points(at(p, motion_displacement=-0.5 * p.spacer), "top")[1] == pytest.approx(0.0)


def test_above_the_table_the_step_fails() -> None:
    p = physics.Params(**BENCH)
    with pytest.raises(ValueError, match="above the film's table"):
        at(p, top_voltage=1.02 * math.sqrt(LOADING[1] / physics.loading(p, 1.0)))
    with pytest.raises(ValueError, match="higher than the film's table"):
        at(p, motion_displacement=11e-3)
