"""Direct solution of the conical membrane: Ritz's method with exact Hessian.

Pi(h, V) = min over r(R), z(R) of (2 pi n T / lp^2) int w(l1, l2) R dR with
l1 = lp sqrt(r'^2 + z'^2), l2 = lp r/R, r = R on both rims, z = h inside and 0 outside.
Fields are expanded in integrated Legendre polynomials of s = ln(R/a)/ln(b/a), which resolves
the gradient at the inner rim; the minimum is found by Newton's method with line search, at
each stage of a continuation in h and V^2. Everything else follows from Pi:

    F = dPi/dh,  C = -2 dPi/d(V^2),  and their derivatives by the implicit function theorem.

The paper prints R in its equation 4 where this derivation has r: the force is
2 pi r (T/(l1 l2)) sigma_1 sin(theta), sigma_1 the true stress.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from .film import Array, Film, density, dielectric

MODES = 16
TOLERANCE = 1e-10
"""Newton step over b at which to stop; the error left is of the order of its square."""
MOST_ITERATIONS = 60
CONTINUATION = 8


class NoEquilibriumError(ValueError):
    """There is no stable taut equilibrium: slack, pulled in, or beyond the solver."""


@dataclass(frozen=True)
class Basis:
    """Quadrature nodes s and weights on [0, 1], and the modes with their derivatives by s."""

    nodes: Array
    weights: Array
    shapes: Array
    slopes: Array


@dataclass(frozen=True)
class Equilibrium:
    """Potential [J], force [N], capacitance [F] and second derivatives of the potential by
    height and squared voltage; the modes' coefficients, to start a neighbour from."""

    height: float
    square: float
    energy: float
    force: float
    capacitance: float
    stiffness: float
    force_by_square: float
    capacitance_by_square: float
    coefficients: Array


@dataclass(frozen=True)
class Shape:
    """Profile over the flat radius R: position, stretches, nominal stresses [Pa], true field."""

    flat_radius: Array
    radius: Array
    height: Array
    meridional_stretch: Array
    hoop_stretch: Array
    meridional_stress: Array
    hoop_stress: Array
    field: Array


@functools.cache
def basis(modes: int) -> Basis:
    """Integrated Legendre modes (P_{k+1} - P_{k-1})/(2 (2k+1)), zero at both ends."""
    x, w = legendre.leggauss(3 * modes + 12)
    slopes = []
    for k in range(1, modes + 1):
        unit = np.zeros(k + 1)
        unit[k] = 1.0
        slopes.append(legendre.legval(x, unit))
    return Basis(0.5 * (x + 1.0), 0.5 * w, _modes(modes, x), np.array(slopes))


def _modes(count: int, x: Array) -> Array:
    """The modes at x = 2 s - 1."""
    shapes = []
    for k in range(1, count + 1):
        upper, lower = np.zeros(k + 2), np.zeros(k + 2)
        upper[k + 1], lower[k - 1] = 1.0, 1.0
        shapes.append(legendre.legval(x, (upper - lower) / (2.0 * (2 * k + 1))))
    return np.array(shapes)


@dataclass(frozen=True)
class _Problem:
    """Geometry of one solve at the quadrature nodes."""

    film: Film
    modes: Basis
    flat: Array
    scale: Array
    weights: Array

    @classmethod
    def of(cls, film: Film, modes: int) -> _Problem:
        shapes = basis(modes)
        stretch = np.log(film.outer_radius / film.inner_radius)
        flat = film.inner_radius * np.exp(stretch * shapes.nodes)
        scale = 1.0 / (stretch * flat)
        return cls(film, shapes, flat, scale, film.volume * shapes.weights * flat * flat * stretch)

    def fields(self, q: Array, height: float) -> tuple[Array, Array, Array, Array]:
        """r, dr/dR, z, dz/dR at the nodes."""
        half = len(q) // 2
        size = self.film.outer_radius
        r = self.flat + size * (q[:half] @ self.modes.shapes)
        dr = 1.0 + size * self.scale * (q[:half] @ self.modes.slopes)
        z = height * (1.0 - self.modes.nodes) + size * (q[half:] @ self.modes.shapes)
        dz = self.scale * (size * (q[half:] @ self.modes.slopes) - height)
        return r, dr, z, dz

    def evaluate(
        self, q: Array, height: float, square: float
    ) -> tuple[float, Array, Array, Array, Array, Array]:
        """Energy, gradient, Hessian; mixed derivatives of the gradient; explicit derivatives.

        The last array holds Pi_h, Pi_E, Pi_hh, Pi_hE at fixed modes (Pi_EE is zero there).
        """
        film = self.film
        r, dr, _, dz = self.fields(q, height)
        rho = np.sqrt(dr * dr + dz * dz)
        lp = film.prestretch
        l1, l2 = lp * rho, lp * r / self.flat
        if not (np.all(l2 > 1e-3) and np.all(rho > 1e-6)):
            raise FloatingPointError
        d = density(film, l1, l2, square)
        c, s = dr / rho, dz / rho
        g, t = self.weights, lp * d.w1 / rho
        hoop = lp / self.flat
        size = film.outer_radius
        shape, slope = size * self.modes.shapes, size * self.modes.slopes * self.scale
        by_r, by_dr, by_dz = g * hoop * d.w2, g * lp * d.w1 * c, g * lp * d.w1 * s
        gradient = np.concatenate([shape @ by_r + slope @ by_dr, slope @ by_dz])
        a, b = lp * lp * d.w11, lp * hoop * d.w12
        rr, rx, ry = g * hoop * hoop * d.w22, g * b * c, g * b * s
        xx = g * (a * c * c + t * s * s)
        xy = g * (a - t) * c * s
        yy = g * (a * s * s + t * c * c)
        upper = (shape * rr) @ shape.T + (slope * xx) @ slope.T
        cross = (shape * rx) @ slope.T
        mixed = (shape * ry) @ slope.T + (slope * xy) @ slope.T
        hessian = np.block([[upper + cross + cross.T, mixed], [mixed.T, (slope * yy) @ slope.T]])
        lift = -self.scale
        by_h = np.concatenate([shape @ (ry * lift) + slope @ (xy * lift), slope @ (yy * lift)])
        load = -0.5 * film.loading
        field = dielectric(film, l1, l2)
        m1, m2 = load * field.g1, load * field.g2
        by_e = np.concatenate(
            [
                shape @ (g * hoop * m2) + slope @ (g * lp * m1 * c),
                slope @ (g * lp * m1 * s),
            ]
        )
        explicit = np.array(
            [
                float(by_dz @ lift),
                float(g @ (load * field.g)),
                float((yy * lift) @ lift),
                float((g * lp * m1 * s) @ lift),
            ]
        )
        return float(g @ d.w), gradient, hessian, by_h, by_e, explicit


def equilibrium(
    film: Film,
    height: float,
    voltage: float,
    modes: int = MODES,
    guess: Equilibrium | None = None,
) -> Equilibrium:
    """Stable taut equilibrium at a height [m] and voltage [V].

    From `guess` if given, else by continuation from a taut cone without voltage. Raises
    :class:`NoEquilibriumError` where Newton's method leaves the taut branch or the Hessian is
    not positive definite: pull-in, or a cone that is slack.
    """
    if not 0.0 < height < 20.0 * film.outer_radius:
        raise NoEquilibriumError(f"height {height:g} m is not between 0 and 20 outer radii")
    if guess is not None:
        return _solved(film, height, voltage * voltage, modes, guess.coefficients)
    start = max(height, 0.5 * film.outer_radius)
    q = np.zeros(2 * modes)
    found = _solved(film, start, 0.0, modes, q)
    square = voltage * voltage
    for k in range(1, CONTINUATION + 1):
        found = _solved(film, start, square * k / CONTINUATION, modes, found.coefficients)
    if height < start:
        for k in range(1, CONTINUATION + 1):
            h = start + (height - start) * k / CONTINUATION
            found = _solved(film, h, square, modes, found.coefficients)
    return found


def _solved(film: Film, height: float, square: float, modes: int, q: Array) -> Equilibrium:
    """Newton's method with line search from the modes `q`; checked for stability."""
    problem = _Problem.of(film, modes)
    if len(q) != 2 * modes:
        raise ValueError("the guess has another number of modes")
    energy, gradient, hessian, by_h, by_e, explicit = problem.evaluate(q, height, square)
    size = film.volume * film.outer_radius**2 * film.moduli[0]
    for _ in range(MOST_ITERATIONS):
        step = -_descent(hessian, gradient)
        length = 1.0
        while True:
            try:
                trial = problem.evaluate(q + length * step, height, square)
                if trial[0] <= energy + 1e-13 * (abs(energy) + size):
                    break
            except FloatingPointError:
                pass
            length *= 0.5
            if length < 1e-8:
                raise NoEquilibriumError(_place(height, square, "Newton's method stalls"))
        q = q + length * step
        energy, gradient, hessian, by_h, by_e, explicit = trial
        if length == 1.0 and np.abs(step).max() < TOLERANCE:
            break
    else:
        raise NoEquilibriumError(_place(height, square, "no convergence"))
    try:
        np.linalg.cholesky(hessian)
    except np.linalg.LinAlgError:
        raise NoEquilibriumError(_place(height, square, "not stable")) from None
    if explicit[0] <= 0.0:
        raise NoEquilibriumError(_place(height, square, "slack"))
    follow = np.linalg.solve(hessian, np.column_stack([by_h, by_e]))
    return Equilibrium(
        height=height,
        square=square,
        energy=energy,
        force=float(explicit[0]),
        capacitance=float(-2.0 * explicit[1]),
        stiffness=float(explicit[2] - by_h @ follow[:, 0]),
        force_by_square=float(explicit[3] - by_h @ follow[:, 1]),
        capacitance_by_square=float(2.0 * (by_e @ follow[:, 1])),
        coefficients=q,
    )


def _descent(hessian: Array, gradient: Array) -> Array:
    """Newton direction; with the Hessian shifted where it is not positive definite."""
    shift = 0.0
    unit = np.abs(np.diag(hessian)).max()
    for _ in range(30):
        try:
            factor = np.linalg.cholesky(hessian + shift * np.eye(len(gradient)))
        except np.linalg.LinAlgError:
            shift = max(4.0 * shift, 1e-6 * unit)
            continue
        return np.asarray(np.linalg.solve(factor.T, np.linalg.solve(factor, gradient)))
    raise NoEquilibriumError("the Hessian cannot be made positive definite")


def _place(height: float, square: float, what: str) -> str:
    return f"no taut equilibrium at h = {height:g} m, V = {np.sqrt(square):g} V: {what}"


def shape(film: Film, found: Equilibrium) -> Shape:
    """Profile, stretches, stresses and field of an equilibrium over the flat radius."""
    problem = _Problem.of(film, len(found.coefficients) // 2)
    r, dr, z, dz = problem.fields(found.coefficients, found.height)
    l1 = film.prestretch * np.sqrt(dr * dr + dz * dz)
    l2 = film.prestretch * r / problem.flat
    d = density(film, l1, l2, found.square)
    return Shape(
        flat_radius=problem.flat,
        radius=r,
        height=z,
        meridional_stretch=l1,
        hoop_stretch=l2,
        meridional_stress=d.w1,
        hoop_stress=d.w2,
        field=np.sqrt(found.square) / film.thickness * l1 * l2,
    )


def profile(film: Film, found: Equilibrium, places: Sequence[float]) -> tuple[Array, Array]:
    """Radius and height [m] of the points at s = ln(R/a)/ln(b/a), 0 to 1."""
    half = len(found.coefficients) // 2
    s = np.asarray(places, dtype=float)
    shapes = _modes(half, 2.0 * s - 1.0)
    flat = film.inner_radius * (film.outer_radius / film.inner_radius) ** s
    radius = flat + film.outer_radius * (found.coefficients[:half] @ shapes)
    height = found.height * (1.0 - s) + film.outer_radius * (found.coefficients[half:] @ shapes)
    return radius, height
