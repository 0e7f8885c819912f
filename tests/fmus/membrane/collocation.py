"""Conical dielectric elastomer membrane by collocation: a reference for the tests.

The energy of one layer, with `R` the radius in the flat pre-stretched state,

    Pi = (2 pi T / lp^2) int_a^b w(l1, l2) R dR,
    w  = sum_i mu_i/a_i (l1^a_i + l2^a_i + (l1 l2)^-a_i - 3) - (eps/2) (V/T)^2 l1^2 l2^2,
    l1 = lp sqrt(r'^2 + z'^2),   l2 = lp r/R,   s_i = dw/dl_i,

is stationary, with `r' = l1 cos(th)/lp` and `z' = l1 sin(th)/lp`, where

    S = R s1 sin(th) is constant   and   P = R s1 cos(th) obeys P' = s2.

`r, z, P` are the unknown functions and `S` an unknown parameter. Lengths are divided by
`b`, stresses by `sum_i mu_i`, and the collocation runs over `x = ln R`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

Array = NDArray[np.float64]

_COARSE = 1e-5
"""Tolerance on the way to the wanted height and voltage."""

_LONGEST = 50.0
"""Largest meridional stretch looked for."""

_SHORTEST_STEP = 5e-3
"""Fraction of the way below which continuation gives up."""


class NoEquilibriumError(RuntimeError):
    """No taut axisymmetric equilibrium was reached: slack or past pull-in."""


@dataclass(frozen=True)
class Solution:
    """One layer in equilibrium at fixed height and voltage.

    Attributes
    ----------
    force
        `dPi/dh` [N], positive when the disc is pulled back to the plane of the ring.
    capacitance
        `(2 pi eps/(T lp^2)) int l1^2 l2^2 R dR` [F].
    energy
        `Pi` [J], elastic energy minus `C V^2/2`.
    flat_radius
        `R` [m] of the collocation nodes, inner edge first.
    radius, height_profile
        Deformed `r` and `z` [m] at the same nodes.
    stretch_meridional, stretch_hoop
        `l1` and `l2` at the same nodes, both including the pre-stretch.
    """

    force: float
    capacitance: float
    energy: float
    flat_radius: Array
    radius: Array
    height_profile: Array
    stretch_meridional: Array
    stretch_hoop: Array


@dataclass(frozen=True)
class _Law:
    """Energy density `w/mu` and its derivatives, `e = eps (V/T)^2/mu`, `mu = sum_i mu_i`."""

    moduli: tuple[float, ...]
    exponents: tuple[float, ...]
    field: float

    def energy(self, l1: Array, l2: Array) -> Array:
        """Return `w` with the electrical part `-(e/2) l1^2 l2^2`."""
        w = -0.5 * self.field * (l1 * l2) ** 2
        for m, a in zip(self.moduli, self.exponents, strict=True):
            w = w + m / a * (l1**a + l2**a + (l1 * l2) ** -a - 3.0)
        return w

    def stress(self, l1: Array, l2: Array) -> Array:
        """Return `s1 = sum m (l1^(a-1) - l1^(-a-1) l2^-a) - e l1 l2^2`; `s2` by exchange."""
        s = -self.field * l1 * l2**2
        for m, a in zip(self.moduli, self.exponents, strict=True):
            s = s + m * (l1**a - (l1 * l2) ** -a) / l1
        return s

    def stiffness(self, l1: Array, l2: Array) -> Array:
        """Return `d2w/dl1^2`; `d2w/dl2^2` by exchange."""
        k = -self.field * l2**2
        for m, a in zip(self.moduli, self.exponents, strict=True):
            k = k + m * ((a - 1.0) * l1**a + (a + 1.0) * (l1 * l2) ** -a) / l1**2
        return k

    def coupling(self, l1: Array, l2: Array) -> Array:
        """Return `d2w/dl1 dl2 = sum m a (l1 l2)^(-a-1) - 2 e l1 l2`."""
        k = -2.0 * self.field * l1 * l2
        for m, a in zip(self.moduli, self.exponents, strict=True):
            k = k + m * a * (l1 * l2) ** (-a - 1.0)
        return k

    def meridional(self, stress: Array, l2: Array) -> Array:
        """Return the smallest `l1` with `s1(l1, l2) = stress >= 0`, by Newton within a bracket.

        `l1 = l2^(-1/2)` is free of elastic stress, and the field only lowers `s1`, so it is
        a lower bound. Where no root exists the upper end of the search is returned.
        """
        low = l2**-0.5
        high = 1.1 * low
        for _ in range(200):
            short = (self.stress(high, l2) < stress) & (high < _LONGEST)
            if not short.any():
                break
            low = np.where(short, high, low)
            high = np.where(short, 1.1 * high, high)
        l1 = 0.5 * (low + high)
        for _ in range(100):
            excess = self.stress(l1, l2) - stress
            low = np.where(excess < 0.0, l1, low)
            high = np.where(excess < 0.0, high, l1)
            slope = self.stiffness(l1, l2)
            step = l1 - excess / np.where(slope > 0.0, slope, np.inf)
            inside = (step >= low) & (step <= high) & (slope > 0.0)
            new = np.where(inside, step, 0.5 * (low + high))
            done = np.abs(new - l1) <= 4.0 * np.finfo(float).eps * l1
            l1 = new
            if done.all():
                break
        return l1


@dataclass(frozen=True)
class _Problem:
    """The boundary value problem for `y = (r, z, P)` over `x = ln R`, parameter `p = (S,)`."""

    law: _Law
    prestretch: float
    inner: float
    height: float

    def stretches(self, x: Array, y: Array, p: Array) -> tuple[Array, Array]:
        """Return `l1` from `s1 = sqrt(P^2 + S^2)/R`, and `l2 = lp r/R`."""
        big_r = np.exp(x)
        l2 = np.maximum(self.prestretch * y[0] / big_r, 1e-2)  # binds in stray iterates only
        return self.law.meridional(np.hypot(y[2], p[0]) / big_r, l2), l2

    def slope(self, x: Array, y: Array, p: Array) -> Array:
        """Return `R (l1 cos(th)/lp, l1 sin(th)/lp, s2)`."""
        big_r = np.exp(x)
        l1, l2 = self.stretches(x, y, p)
        scale = big_r * l1 / (self.prestretch * np.hypot(y[2], p[0]))
        return np.vstack((scale * y[2], scale * p[0], big_r * self.law.stress(l2, l1)))

    def jacobian(self, x: Array, y: Array, p: Array) -> tuple[Array, Array]:
        """Return the derivatives of `slope` to `y` and `p`.

        `dl1 = (ds1 - w12 dl2)/w11`, `ds1 = (cos dP + sin dS)/R`, `dl2 = lp dr/R`,
        `dth = (cos dS - sin dP)/sqrt(P^2 + S^2)`.
        """
        big_r, lp = np.exp(x), self.prestretch
        l1, l2 = self.stretches(x, y, p)
        pull = np.hypot(y[2], p[0])
        cos, sin = y[2] / pull, p[0] / pull
        w11, w12 = self.law.stiffness(l1, l2), self.law.coupling(l1, l2)
        w22 = self.law.stiffness(l2, l1)

        def column(d_s1: Array, d_l2: Array, d_angle: Array) -> Array:
            d_l1 = (d_s1 - w12 * d_l2) / w11
            d_r = (d_l1 * cos - l1 * sin * d_angle) / lp
            d_z = (d_l1 * sin + l1 * cos * d_angle) / lp
            return np.stack((big_r * d_r, big_r * d_z, big_r * (w12 * d_l1 + w22 * d_l2)))

        none = np.zeros_like(x)
        by_r = column(none, lp / big_r, none)
        by_p = column(cos / big_r, none, -sin / pull)
        by_s = column(sin / big_r, none, cos / pull)
        return np.stack((by_r, np.zeros_like(by_r), by_p), axis=1), by_s[:, None, :]

    def edges(self, ya: Array, yb: Array, p: Array) -> Array:
        """Return the misfit of `r(a) = a, z(a) = h, r(b) = b, z(b) = 0`."""
        return np.array([ya[0] - self.inner, ya[1] - self.height, yb[0] - 1.0, yb[1]])

    def log_profile(self) -> tuple[Array, Array, Array]:
        """Return the guess `r = R`, `z = h ln(b/R)/ln(b/a)`, the small-slope shape at h << b."""
        x = np.linspace(np.log(self.inner), 0.0, 81)
        big_r = np.exp(x)
        tangent = self.height / (x[0] * big_r)
        l1 = self.prestretch * np.hypot(1.0, tangent)
        pull = big_r * self.law.stress(l1, np.full_like(l1, self.prestretch))
        cos = 1.0 / np.hypot(1.0, tangent)
        y = np.vstack((big_r, self.height * x / x[0], pull * cos))
        return x, y, np.array([np.mean(pull * cos * tangent)])

    def collocate(self, x: Array, y: Array, p: Array, tolerance: float) -> Any:
        """Run `solve_bvp`; return None where it fails or leaves the branch of taut film."""
        with np.errstate(all="ignore"):
            try:
                found = solve_bvp(
                    self.slope,
                    self.edges,
                    x,
                    y,
                    p,
                    fun_jac=self.jacobian,
                    tol=tolerance,
                    max_nodes=2_000 if tolerance >= _COARSE else 20_000,
                )
            except ValueError:  # non-finite iterates
                return None
            if not found.success:
                return None
            l1, l2 = self.stretches(found.x, found.y, found.p)
            wanted = np.hypot(found.y[2], found.p[0]) / np.exp(found.x)
            fits = np.abs(self.law.stress(l1, l2) - wanted) <= 1e-9 * (1.0 + wanted)
            taut = (self.law.stiffness(l1, l2) > 0.0) & (found.y[0] > 0.0)
        return found if bool(np.all(fits & taut)) else None


def _march(problem_at: Callable[[float], _Problem], start: Any) -> Any:
    """Continue the solution of `problem_at(0)` to `problem_at(1)` with steps that adapt."""
    reached, step, here = 0.0, 1.0, start
    while reached < 1.0:
        ahead = min(1.0, reached + step)
        found = problem_at(ahead).collocate(here.x, here.y, here.p, _COARSE)
        if found is None:
            step *= 0.5
            if step < _SHORTEST_STEP:
                raise NoEquilibriumError(f"continuation stopped at {reached:.4f} of its way")
        else:
            reached, step, here = ahead, 1.5 * step, found
    return here


def _integrals(problem: _Problem, found: Any) -> tuple[float, float]:
    """Return `int w R dR` and `int l1^2 l2^2 R dR` by Gauss's rule of four points per interval."""
    points, weights = np.polynomial.legendre.leggauss(4)
    half = 0.5 * np.diff(found.x)
    x = (found.x[:-1] + half)[:, None] + half[:, None] * points
    measure = (half[:, None] * weights * np.exp(2.0 * x)).ravel()
    x = x.ravel()
    l1, l2 = problem.stretches(x, found.sol(x), found.p)
    return (
        float(measure @ problem.law.energy(l1, l2)),
        float(measure @ (l1 * l2) ** 2),
    )


def solve(
    inner_radius: float,
    outer_radius: float,
    thickness: float,
    prestretch: float,
    moduli: tuple[float, ...],
    exponents: tuple[float, ...],
    permittivity: float,
    height: float,
    voltage: float,
    tolerance: float = 1e-11,
) -> Solution:
    """Solve one layer of the cone at fixed height and voltage.

    The first variation of `Pi` at its stationary point leaves the term at the edge,

        F = dPi/dh = -dL/dz'|_a = -(2 pi T/lp) S,   L = (2 pi T/lp^2) w R,

    as `dl1/dz' = lp sin(th)`; `S < 0` for `h > 0`, since `z` falls outwards.

    Compressive hoop stress is allowed. Close to slack (low `h`, high `V`) the stationary
    shape overhangs (`r' < 0`) and rounding keeps the residual above about 1e-10.

    Parameters
    ----------
    inner_radius, outer_radius
        `a` and `b` [m].
    thickness
        `T` [m], before the pre-stretch.
    prestretch
        `lp`, equibiaxial.
    moduli, exponents
        `mu_i` [Pa] and `a_i` of the Ogden energy.
    permittivity
        `eps = eps_0 eps_r` [F/m].
    height
        `h` [m], of either sign; at zero the film is flat and uniform, `l1 = l2 = lp`.
    voltage
        `V` [V] across the layer.
    tolerance
        Relative residual asked of the collocation.

    Raises
    ------
    NoEquilibriumError
        Where the film is slack (`s1 < 0`), past pull-in, or the tolerance is out of reach.
    """
    mu = sum(moduli)
    inner, target = inner_radius / outer_radius, height / outer_radius
    shares = tuple(m / mu for m in moduli)

    def problem(h: float, share: float) -> _Problem:
        field = share * permittivity * (voltage / thickness) ** 2 / mu
        return _Problem(_Law(shares, exponents, field), prestretch, inner, h)

    final = problem(target, 1.0)
    if height == 0.0:
        x = np.linspace(np.log(inner), 0.0, 81)
        y, pull = np.vstack((np.exp(x), 0.0 * x, 0.0 * x)), 0.0
        l1 = l2 = np.full_like(x, prestretch)
        area = 0.5 * (1.0 - inner**2)
        density, squares = area * float(final.law.energy(l1, l2)[0]), area * prestretch**4
        if final.law.stress(l1, l2)[0] < -1e-12:
            raise NoEquilibriumError("the flat film is slack at this voltage")
    else:
        first = float(np.copysign(min(abs(target), 0.5), target))
        found = problem(first, 0.0).collocate(*problem(first, 0.0).log_profile(), _COARSE)
        if found is None:
            raise NoEquilibriumError(f"no passive solution at h/b = {first}")
        if first != target:
            found = _march(lambda t: problem(first + t * (target - first), 0.0), found)
        if voltage != 0.0:
            found = _march(lambda t: problem(target, t), found)
        found = final.collocate(found.x, found.y, found.p, tolerance)
        if found is None:
            raise NoEquilibriumError(f"tolerance {tolerance} not reached")
        x, y, pull = found.x, found.y, -float(found.p[0])
        l1, l2 = final.stretches(x, y, found.p)
        density, squares = _integrals(final, found)

    lateral = 2.0 * np.pi * outer_radius / prestretch
    return Solution(
        force=lateral * thickness * mu * pull,
        capacitance=lateral * outer_radius / prestretch * permittivity / thickness * squares,
        energy=lateral * outer_radius / prestretch * thickness * mu * density,
        flat_radius=outer_radius * np.exp(x),
        radius=outer_radius * y[0],
        height_profile=outer_radius * y[1],
        stretch_meridional=l1,
        stretch_hoop=l2,
    )
