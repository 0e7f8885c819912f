"""The table against direct solutions, its continuation, and its derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmus.membrane import tables
from fmus.membrane.film import Film
from fmus.membrane.potential import extremes, potential
from fmus.membrane.ritz_solver import equilibrium
from fmus.membrane.splines import bends, slopes, values
from fmus.membrane.surrogate import cardinal, group, unit_film

SILICONE = Film(4e-3, 20e-3, 40e-6, (1.287e5, 2.6e4), (2.0, 4.0), 2.8)
FILMS = range(len(tables.FILMS))


@pytest.mark.parametrize("t", [0.0, 0.25, 0.5, 0.99, 1.0])
def test_splines_are_the_cardinal_ones(t: float) -> None:
    np.testing.assert_allclose(values(t), cardinal(5, np.array([t]), 1)[0], atol=1e-15)
    h = 1e-5
    for low, high, slope in zip(values(t - h), values(t + h), slopes(t), strict=True):
        assert (high - low) / (2 * h) == pytest.approx(slope, abs=1e-8)
    for low, high, bend in zip(slopes(t - h), slopes(t + h), bends(t), strict=True):
        assert (high - low) / (2 * h) == pytest.approx(bend, abs=1e-8)


def test_error_of_the_force_over_the_domain() -> None:
    """1e-6 of the largest force up to 1500 V, 1e-5 up to 1920 V."""
    rng = np.random.default_rng(5)
    unit = unit_film(SILICONE)
    errors: dict[bool, float] = {True: 0.0, False: 0.0}
    largest = 0.0
    for _ in range(120):
        x, voltage = rng.uniform(0.3, 1.25), rng.uniform(0.0, 1920.0)
        e = group(SILICONE, voltage)
        exact = equilibrium(unit, x, math.sqrt(e), modes=22)
        largest = max(largest, exact.force)
        error = abs(potential(1, x, e).px - exact.force)
        errors[voltage <= 1500.0] = max(errors[voltage <= 1500.0], error)
    assert errors[True] < 1e-6 * largest
    assert errors[False] < 1e-5 * largest


@pytest.mark.parametrize("film", FILMS)
@pytest.mark.parametrize("place", [0.05, 0.5, 0.95])
@pytest.mark.parametrize("load", [0.1, 0.6, 0.95])
def test_derivatives_belong_to_the_potential(film: int, place: float, load: float) -> None:
    low, high = tables.LOWEST[film], tables.HIGHEST[film]
    x, e = low + place * (high - low), load * tables.LOADING[film]
    dx, de = 1e-4 * (high - low), 1e-4 * tables.LOADING[film]
    here = potential(film, x, e)
    for name, upper, lower, step in (
        ("p", potential(film, x + dx, e), potential(film, x - dx, e), dx),
        ("p", potential(film, x, e + de), potential(film, x, e - de), de),
        ("px", potential(film, x + dx, e), potential(film, x - dx, e), dx),
        ("px", potential(film, x, e + de), potential(film, x, e - de), de),
        ("pe", potential(film, x, e + de), potential(film, x, e - de), de),
    ):
        slope = (getattr(upper, name) - getattr(lower, name)) / (2 * step)
        wanted = {"p": ("px", "pe"), "px": ("pxx", "pxe"), "pe": ("pxe", "pee")}[name]
        assert slope == pytest.approx(getattr(here, wanted[0 if step == dx else 1]), rel=1e-4)


@pytest.mark.parametrize("film", FILMS)
@pytest.mark.parametrize("load", [0.0, 0.4, 0.9])
def test_force_and_charge_are_continuous_down_to_slack(film: int, load: float) -> None:
    """Across the edge of the table and across the onset of slack, both from one potential."""
    e = load * tables.LOADING[film]
    xs = np.linspace(-0.5, tables.LOWEST[film] + 0.1, 4001)
    found = [potential(film, float(x), e) for x in xs]
    force = np.array([p.px for p in found])
    charge = np.array([p.pe for p in found])
    energy = np.array([p.p for p in found])
    step = xs[1] - xs[0]
    assert np.abs(np.diff(force)).max() < 3.0 * step * max(p.pxx for p in found)
    assert np.abs(np.diff(charge)).max() < 50 * step * max(1.0, np.abs(charge).max())
    assert (force >= 0.0).all()
    np.testing.assert_allclose(
        np.diff(energy), 0.5 * (force[1:] + force[:-1]) * step, atol=1e-5 * np.ptp(energy)
    )
    assert found[0].slack == 2.0
    assert found[-1].slack == 0.0


@pytest.mark.parametrize("film", FILMS)
def test_above_the_table_there_is_no_answer(film: int) -> None:
    with pytest.raises(ValueError, match="pull-in"):
        potential(film, 0.7, 1.01 * tables.LOADING[film])
    with pytest.raises(ValueError, match="higher than"):
        potential(film, tables.HIGHEST[film] + 0.01, 0.0)


def test_the_field_at_the_inner_edge() -> None:
    """90 V/um at h = 15 mm and 1920 V; hoop tension lost from 1463 V on."""
    stretch, hoop = extremes(1, 0.75, group(SILICONE, 1920.0))
    assert 1920.0 / 40e-6 * stretch == pytest.approx(90e6, rel=0.03)
    assert hoop < 0.0
    assert extremes(1, 0.75, group(SILICONE, 1400.0))[1] > 0.0
