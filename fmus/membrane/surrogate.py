"""The membrane's potential as one smooth table, fitted once to direct solutions.

In the groups x = h/b and e = eps V^2/(mu_1 T^2) the potential of a cone is

    Pi(h, V) = (2 pi n T / lp^2) b^2 mu_1 P(x, e; a/b, mu_i/mu_1, alpha_i, lp),

so thickness, modulus, radius and layers need no new table. P is sampled at Chebyshev nodes
by the direct solver, and the Chebyshev polynomial through them is carried over to uniform
quintic B-splines by least squares: four times continuously differentiable, local, and ONE
potential, so that F = dPi/dh and Q = -dPi/dV conserve energy by construction, however coarse
the table. The taut range of each table is a rectangle; see `physics.py` for what lies beyond.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from ..constants import VACUUM_PERMITTIVITY
from .film import Array, Film
from .ritz_solver import Equilibrium, equilibrium, shape

SPLINE = 5
FIELD_POINTS = (16, 10)


@dataclass(frozen=True)
class Range:
    """Rectangle of a table in x = h/b and e = eps V^2/(mu_1 T^2), its nodes and cells."""

    lowest: float
    highest: float
    loading: float
    nodes: tuple[int, int] = (28, 20)
    cells: tuple[int, int] = (40, 26)
    modes: int = 20

    def __post_init__(self) -> None:
        if not 0.0 < self.lowest < self.highest:
            raise ValueError("a table needs 0 < lowest < highest")
        if self.loading <= 0.0:
            raise ValueError("a table needs a voltage above zero")


def group(film: Film, voltage: float) -> float:
    """The loading e = eps V^2/(mu_1 T^2)."""
    return film.loading * voltage * voltage / film.moduli[0]


def unit_film(film: Film) -> Film:
    """The same film with b = 1, mu_1 = 1, volume 1 and e = V^2."""
    thickness = film.prestretch**2 / (2.0 * math.pi)
    return replace(
        film,
        inner_radius=film.inner_radius / film.outer_radius,
        outer_radius=1.0,
        thickness=thickness,
        moduli=tuple(mu / film.moduli[0] for mu in film.moduli),
        permittivity=thickness * thickness / VACUUM_PERMITTIVITY,
        layers=1.0,
    )


def cardinal(degree: int, points: Array, cells: int) -> Array:
    """Uniform B-splines of a degree on `cells` cells of [0, 1], at points: rows of weights."""
    place = np.clip(points * cells, 0.0, cells)
    cell = np.minimum(place.astype(int), cells - 1)
    t = place - cell
    local = np.ones((len(points), 1))
    for k in range(1, degree + 1):
        local = _next(local, t, k)
    rows = np.zeros((len(points), cells + degree))
    for j in range(degree + 1):
        rows[np.arange(len(points)), cell + j] = local[:, j]
    return rows


def _next(local: Array, t: Array, k: int) -> Array:
    """Cox-de Boor step from degree k - 1 to k on uniform knots."""
    wider = np.zeros((len(t), k + 1))
    for j in range(k + 1):
        if j > 0:
            wider[:, j] += (t + (k - j)) / k * local[:, j - 1]
        if j < k:
            wider[:, j] += (j + 1.0 - t) / k * local[:, j]
    return wider


def samples(film: Film, span: Range, xs: Array, es: Array) -> list[list[Equilibrium]]:
    """Direct solutions of the unit film on a grid, each started from its neighbour."""
    rows: list[list[Equilibrium]] = []
    start: Equilibrium | None = None
    order = np.argsort(es)
    for x in xs[np.argsort(np.abs(xs - 0.75))]:
        row: list[Equilibrium | None] = [None] * len(es)
        guess = start
        for j in order:
            guess = equilibrium(film, float(x), math.sqrt(es[j]), span.modes, guess)
            row[int(j)] = guess
            if start is None:
                start = guess
        start = row[int(order[0])]
        rows.append([found for found in row if found is not None])
    place = np.argsort(np.argsort(np.abs(xs - 0.75)))
    return [rows[int(k)] for k in place]


def solved(unit: Film, span: Range) -> list[list[Equilibrium]]:
    """Direct solutions at the Chebyshev nodes of a range: a row for each x, from the lowest."""
    tx, te = (chebyshev_nodes(n) for n in span.nodes)
    xs = span.lowest + (span.highest - span.lowest) * tx
    return samples(unit, span, xs, span.loading * te)


def splined(values: Array, cells: tuple[int, int]) -> Array:
    """B-spline coefficients over `cells` of the polynomial through values at Chebyshev nodes."""
    coefficients = values
    for axis, (count, wanted) in enumerate(zip(values.shape, cells, strict=True)):
        nodes = chebyshev_nodes(count)
        to_series = np.linalg.inv(chebyshev.chebvander(2.0 * nodes - 1.0, count - 1))
        points = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 8 * wanted)))
        dense = chebyshev.chebvander(2.0 * points - 1.0, count - 1)
        fit = np.linalg.lstsq(cardinal(SPLINE, points, wanted), dense, rcond=None)[0] @ to_series
        coefficients = fit @ coefficients if axis == 0 else coefficients @ fit.T
    return coefficients


def chebyshev_nodes(count: int) -> Array:
    """Chebyshev nodes of [0, 1], rising."""
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * (np.arange(count) + 0.5) / count)))


def table(film: Film, span: Range) -> dict[str, Any]:
    """Table of a film over a range, as plain numbers and lists.

    Keys: the range, what it was made for, `potential` (B-spline coefficients, one row per
    cell in x) and `field` (largest l1 l2 over the cone at a coarse grid).
    """
    unit = unit_film(film)
    found = solved(unit, span)
    coefficients = splined(np.array([[point.energy for point in row] for row in found]), span.cells)
    gx, ge = (np.linspace(0.0, 1.0, n) for n in FIELD_POINTS)
    coarse = samples(unit, span, span.lowest + (span.highest - span.lowest) * gx, span.loading * ge)
    profiles = [[shape(unit, point) for point in row] for row in coarse]
    return {
        "lowest": span.lowest,
        "highest": span.highest,
        "loading": span.loading,
        "ratio": unit.inner_radius,
        "prestretch": film.prestretch,
        "cells": list(span.cells),
        "potential": [[float(c) for c in row] for row in coefficients],
        "field": [
            [float((p.meridional_stretch * p.hoop_stretch).max()) for p in row] for row in profiles
        ],
        "hoop": [[float(p.hoop_stress.min()) for p in row] for row in profiles],
    }
