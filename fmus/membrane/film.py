"""One cone of dielectric film: geometry and elastomer, and the energy of a stretched point.

With l1 the meridional and l2 the hoop stretch of an incompressible film, T its thickness
before any stretch and V the voltage across it, the energy per undeformed volume is

    w = sum_i mu_i/a_i (l1^a_i + l2^a_i + (l1 l2)^-a_i - 3) - eps/2 (V/T)^2 g(l1 l2)
    g(J) = J^2 (1 - k (J - 1))

(Ogden 1972; the paper's equation 5 is l1 dw/dl1 at V = 0). With k = 0 the dielectric is ideal; with
k > 0 its permittivity falls in proportion to the stretch of the area.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..constants import VACUUM_PERMITTIVITY

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Film:
    """Annulus a..b in the flat pre-stretched state [m], layers of thickness T [m] before
    pre-stretch, Ogden moduli [Pa] and exponents, relative permittivity without stretch and its
    fall k with the area's."""

    inner_radius: float
    outer_radius: float
    thickness: float
    moduli: tuple[float, ...]
    exponents: tuple[float, ...]
    permittivity: float
    prestretch: float = 1.0
    layers: float = 1.0
    permittivity_fall: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.inner_radius < self.outer_radius:
            raise ValueError("a film needs 0 < inner_radius < outer_radius")
        if len(self.moduli) != len(self.exponents) or not self.moduli:
            raise ValueError("a film needs as many moduli as exponents, at least one")
        if min(self.thickness, self.permittivity, self.prestretch, self.layers) <= 0.0:
            raise ValueError("thickness, permittivity, prestretch and layers are above zero")
        if any(mu * alpha <= 0.0 for mu, alpha in zip(self.moduli, self.exponents, strict=True)):
            raise ValueError("each modulus needs the sign of its exponent")
        if not 0.0 <= self.permittivity_fall < 1.0:
            raise ValueError("permittivity_fall is from 0 to below 1")

    @property
    def loading(self) -> float:
        """eps / T^2 [F/m3]: the electrical energy density per V^2."""
        return VACUUM_PERMITTIVITY * self.permittivity / (self.thickness * self.thickness)

    @property
    def volume(self) -> float:
        """2 pi n T / lp^2 [m]: undeformed volume per R dR."""
        return 2.0 * np.pi * self.layers * self.thickness / self.prestretch**2


@dataclass(frozen=True)
class Density:
    """w [J/m3] and its first and second derivatives by l1 and l2."""

    w: Array
    w1: Array
    w2: Array
    w11: Array
    w12: Array
    w22: Array


@dataclass(frozen=True)
class Dielectric:
    """g(l1 l2) of the energy's electrical part and its derivatives by l1 and l2."""

    g: Array
    g1: Array
    g2: Array
    g11: Array
    g12: Array
    g22: Array


def dielectric(film: Film, l1: Array, l2: Array) -> Dielectric:
    """g(J) = J^2 (1 - k (J - 1)) at J = l1 l2, and its derivatives."""
    k = film.permittivity_fall
    area = l1 * l2
    slope = area * (2.0 * (1.0 + k) - 3.0 * k * area)
    bend = 2.0 * (1.0 + k) - 6.0 * k * area
    return Dielectric(
        g=area * area * (1.0 + k - k * area),
        g1=slope * l2,
        g2=slope * l1,
        g11=bend * l2 * l2,
        g12=bend * area + slope,
        g22=bend * l1 * l1,
    )


def density(film: Film, l1: Array, l2: Array, square: float) -> Density:
    """Energy density and its first and second derivatives at V^2 = `square` [V2]."""
    load = -0.5 * film.loading * square
    d = dielectric(film, l1, l2)
    w, w1, w2 = load * d.g, load * d.g1, load * d.g2
    w11, w12, w22 = load * d.g11, load * d.g12, load * d.g22
    for mu, alpha in zip(film.moduli, film.exponents, strict=True):
        p1, p2 = l1**alpha, l2**alpha
        p3 = 1.0 / (p1 * p2)
        w = w + mu / alpha * (p1 + p2 + p3 - 3.0)
        w1 = w1 + mu * (p1 - p3) / l1
        w2 = w2 + mu * (p2 - p3) / l2
        w11 = w11 + mu * ((alpha - 1.0) * p1 + (alpha + 1.0) * p3) / (l1 * l1)
        w22 = w22 + mu * ((alpha - 1.0) * p2 + (alpha + 1.0) * p3) / (l2 * l2)
        w12 = w12 + mu * alpha * p3 / (l1 * l2)
    return Density(w, w1, w2, w11, w12, w22)
