"""The Ritz solver against printed digits, an independent collocation, and itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmus.membrane.film import VACUUM_PERMITTIVITY, Film, dielectric
from fmus.membrane.ritz_solver import NoEquilibriumError, equilibrium, shape
from tests.fmus.membrane import collocation

SILICONE = Film(4e-3, 20e-3, 40e-6, (1.287e5, 2.6e4), (2.0, 4.0), 2.8)


@pytest.mark.parametrize(
    ("height", "voltage", "force"),
    [
        (15e-3, 0.0, 0.3318281658174),
        (15e-3, 1920.0, 0.176062810442),
        (10e-3, 0.0, 0.1438069237295),
        (12.5e-3, 0.0, 0.2313789359),
    ],
)
def test_forces_of_the_feasibility_study(height: float, voltage: float, force: float) -> None:
    assert equilibrium(SILICONE, height, voltage).force == pytest.approx(force, rel=1e-9)


@pytest.mark.parametrize(("height", "voltage"), [(9e-3, 900.0), (15e-3, 1920.0), (22e-3, 1500.0)])
def test_two_discretisations_agree(height: float, voltage: float) -> None:
    ritz = equilibrium(SILICONE, height, voltage, modes=24)
    other = collocation.solve(
        4e-3, 20e-3, 40e-6, 1.0, (1.287e5, 2.6e4), (2.0, 4.0),
        2.8 * VACUUM_PERMITTIVITY, height, voltage, tolerance=1e-10,
    )  # fmt: skip
    assert ritz.force == pytest.approx(other.force, rel=1e-8)
    assert ritz.capacitance == pytest.approx(other.capacitance, rel=1e-8)
    assert ritz.energy == pytest.approx(other.energy, rel=1e-8)


@pytest.mark.parametrize("fall", [0.0, 0.37])
@pytest.mark.parametrize("prestretch", [1.0, 1.2, 4.0])
def test_derivatives_are_those_of_the_potential(prestretch: float, fall: float) -> None:
    """F = dPi/dh, C = -2 dPi/dE, and reciprocity dF/dE = -1/2 dC/dh."""
    film = Film(
        4e-3, 20e-3, 40e-6, (1.287e5, 2.6e4), (2.0, 4.0), 2.8, prestretch,
        permittivity_fall=fall if prestretch < 2.0 else 0.05 * fall,
    )  # fmt: skip
    h, square = 15e-3, (1200.0 / prestretch) ** 2
    here = equilibrium(film, h, square**0.5)
    dh, de = 2e-5, 1e-4 * square
    high, low = (equilibrium(film, h + s * dh, square**0.5, guess=here) for s in (1, -1))
    more, less = (equilibrium(film, h, (square + s * de) ** 0.5, guess=here) for s in (1, -1))
    assert (high.energy - low.energy) / (2 * dh) == pytest.approx(here.force, rel=1e-6)
    assert (high.force - low.force) / (2 * dh) == pytest.approx(here.stiffness, rel=1e-6)
    assert (more.energy - less.energy) / de == pytest.approx(-here.capacitance, rel=1e-6)
    assert (more.force - less.force) / (2 * de) == pytest.approx(here.force_by_square, rel=1e-6)
    reciprocal = -0.5 * (high.capacitance - low.capacitance) / (2 * dh)
    assert here.force_by_square == pytest.approx(reciprocal, rel=1e-6)


def test_a_falling_permittivity_takes_capacitance_and_stress() -> None:
    """C of a flat film, stretched in proportion by J: C_0 J^2 (1 - k (J - 1)) at no voltage."""
    film = replace(SILICONE, permittivity_fall=0.37)
    stretch = np.array([1.0, 1.2, 1.5])
    d = dielectric(film, np.sqrt(stretch), np.sqrt(stretch))
    assert d.g == pytest.approx(stretch**2 * (1.0 - 0.37 * (stretch - 1.0)))
    constant, falling = (equilibrium(each, 15e-3, 1500.0) for each in (SILICONE, film))
    assert falling.capacitance < constant.capacitance
    assert falling.force > constant.force


@pytest.mark.parametrize("spacer", [25e-3, 30e-3])
def test_passive_force_is_nearly_linear(spacer: float) -> None:
    """Figure 7's claim: within 1 % over 3.5 mm to either side."""
    x = np.linspace(-3.5e-3, 3.5e-3, 15)
    force = np.array(
        [
            equilibrium(SILICONE, spacer / 2 + d, 0.0).force
            - equilibrium(SILICONE, spacer / 2 - d, 0.0).force
            for d in x
        ]
    )
    line = np.polyval(np.polyfit(x, force, 1), x)
    assert np.abs(force - line).max() < 0.01 * np.abs(force).max()


@pytest.mark.parametrize(
    ("inner", "outer", "spacer", "stiffness"),
    [(4e-3, 20e-3, 20e-3, 64.06), (4e-3, 20e-3, 30e-3, 85.03), (1.3e-3, 13e-3, 13e-3, 41.41)],
)
def test_stiffness_of_the_double_cone(
    inner: float, outer: float, spacer: float, stiffness: float
) -> None:
    film = Film(inner, outer, 40e-6, (1.287e5, 2.6e4), (2.0, 4.0), 2.8)
    found = 2.0 * equilibrium(film, spacer / 2, 0.0).stiffness
    assert found == pytest.approx(stiffness, rel=2e-4)


def test_a_layer_more_is_a_factor() -> None:
    double = Film(4e-3, 20e-3, 40e-6, (1.287e5, 2.6e4), (2.0, 4.0), 2.8, layers=2.0)
    one, two = (equilibrium(f, 12e-3, 1000.0) for f in (SILICONE, double))
    assert two.force == pytest.approx(2 * one.force)
    assert two.capacitance == pytest.approx(2 * one.capacitance)


def test_the_first_integral_is_constant() -> None:
    """R s1 sin(theta) does not depend on R: the right form of the paper's equation 4."""
    found = equilibrium(SILICONE, 15e-3, 1500.0, modes=24)
    profile = shape(SILICONE, found)
    slope = np.gradient(profile.height, profile.flat_radius, edge_order=2)
    integral = profile.flat_radius * profile.meridional_stress * -slope / profile.meridional_stretch
    inner = slice(8, -8)
    assert np.ptp(integral[inner]) < 2e-2 * integral.mean()
    assert 2 * np.pi * 40e-6 * integral[inner].mean() == pytest.approx(found.force, rel=1e-2)


@pytest.mark.parametrize(
    ("height", "voltage"),
    [(15e-3, 2500.0), (20e-3, 2300.0), (0.0, 0.0), (-1e-3, 0.0), (1.0, 0.0), (1e-4, 1920.0)],
)
def test_no_wrong_root(height: float, voltage: float) -> None:
    """Past pull-in, at and below the flat state, absurdly high: refused, not answered."""
    try:
        found = equilibrium(SILICONE, height, voltage)
    except NoEquilibriumError:
        return
    assert found.force > 0.0
    assert shape(SILICONE, found).meridional_stress.min() > 0.0


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.9])
@pytest.mark.parametrize("prestretch", [1.0, 4.0])
@pytest.mark.parametrize("thickness", [1e-6, 40e-6])
def test_extreme_films(ratio: float, prestretch: float, thickness: float) -> None:
    film = Film(
        ratio * 20e-3, 20e-3, thickness, (1.287e5, 2.6e4), (2.0, 4.0), 2.8, prestretch, 64.0
    )
    found = equilibrium(film, 10e-3, 0.0, modes=20)
    finer = equilibrium(film, 10e-3, 0.0, modes=28)
    assert found.force == pytest.approx(finer.force, rel=1e-6)
    assert found.stiffness > 0.0
