"""The surrogate potential of a cone and its derivatives, from the tables, in plain floats.

Everything is in the groups x = h/b, e = eps V^2/(mu_1 T^2) and units of
(2 pi n T/lp^2) b^2 mu_1. Inside the table P is a tensor product of uniform quintic
B-splines. Below it (a cone that goes slack) P is continued in x with a constant stiffness
until the force is zero, and is constant in x beyond: a slack film pulls at nothing and keeps the
capacitance it had. Both joints keep force and charge continuous, and both come from the
same potential, so energy closes there too. Above it, in x or e, there is no answer: the
cone has no stable equilibrium nearby, and the step fails.
"""

from __future__ import annotations

from dataclasses import dataclass

from .splines import bends, slopes, values
from .tables import CELLS_E, CELLS_X, FIELD, HIGHEST, HOOP, LOADING, LOWEST, POTENTIAL

Numbers = tuple[float, float, float, float, float, float, float, float, float]

FIELD_X = 15.0
FIELD_E = 9.0


@dataclass(frozen=True)
class Potential:
    """P and its derivatives; `slack` is 0 inside the table, 1 below it, 2 without force."""

    p: float
    px: float
    pe: float
    pxx: float
    pxe: float
    pee: float
    pxxe: float
    pxee: float
    slack: float


def spline(film: int, x: float, e: float) -> Numbers:
    """P and derivatives inside the table's rectangle; both arguments already within it."""
    rows = POTENTIAL[film]
    scale_x = CELLS_X / (HIGHEST[film] - LOWEST[film])
    scale_e = CELLS_E / LOADING[film]
    place_x = (x - LOWEST[film]) * scale_x
    place_e = e * scale_e
    cell_x = min(int(place_x), CELLS_X - 1)
    cell_e = min(int(place_e), CELLS_E - 1)
    n = values(place_x - float(cell_x))
    n1 = slopes(place_x - float(cell_x))
    n2 = bends(place_x - float(cell_x))
    m0, m1, m2, m3, m4, m5 = values(place_e - float(cell_e))
    d0, d1, d2, d3, d4, d5 = slopes(place_e - float(cell_e))
    b0, b1, b2, b3, b4, b5 = bends(place_e - float(cell_e))
    p = 0.0
    px = 0.0
    pxx = 0.0
    pe = 0.0
    pxe = 0.0
    pxxe = 0.0
    pee = 0.0
    pxee = 0.0
    for i in range(6):
        row = rows[cell_x + i]
        c0 = row[cell_e]
        c1 = row[cell_e + 1]
        c2 = row[cell_e + 2]
        c3 = row[cell_e + 3]
        c4 = row[cell_e + 4]
        c5 = row[cell_e + 5]
        s0 = c0 * m0 + c1 * m1 + c2 * m2 + c3 * m3 + c4 * m4 + c5 * m5
        s1 = c0 * d0 + c1 * d1 + c2 * d2 + c3 * d3 + c4 * d4 + c5 * d5
        s2 = c0 * b0 + c1 * b1 + c2 * b2 + c3 * b3 + c4 * b4 + c5 * b5
        w = n[i]
        w1 = n1[i]
        w2 = n2[i]
        p = p + w * s0
        px = px + w1 * s0
        pxx = pxx + w2 * s0
        pe = pe + w * s1
        pxe = pxe + w1 * s1
        pxxe = pxxe + w2 * s1
        pee = pee + w * s2
        pxee = pxee + w1 * s2
    mixed = scale_x * scale_e
    return (
        p,
        px * scale_x,
        pe * scale_e,
        pxx * scale_x * scale_x,
        pxe * mixed,
        pee * scale_e * scale_e,
        pxxe * mixed * scale_x,
        pxee * mixed * scale_e,
        0.0,
    )


def evaluated(film: int, x: float, e: float) -> Numbers:
    """The fields of :class:`Potential` in their order, at any height; see :func:`potential`."""
    if e > LOADING[film]:
        raise ValueError("the voltage is above the membrane's table: near or past pull-in")
    if x > HIGHEST[film]:
        raise ValueError("a cone is higher than the membrane's table: no stable equilibrium nearby")
    low = LOWEST[film]
    load = max(0.0, e)
    if x >= low:
        return spline(film, x, load)
    p, px, pe, _, pxe, pee, _, pxee, _ = spline(film, low, load)
    stiffness = spline(film, low, 0.0)[3]
    reach = x - low
    if px + stiffness * reach > 0.0:
        return (
            p + (px + 0.5 * stiffness * reach) * reach,
            px + stiffness * reach,
            pe + pxe * reach,
            stiffness,
            pxe,
            pee + pxee * reach,
            0.0,
            pxee,
            1.0,
        )
    reach = -px / stiffness
    curve = pee + pxee * reach - pxe * pxe / stiffness
    return p + 0.5 * px * reach, 0.0, pe + pxe * reach, 0.0, 0.0, curve, 0.0, 0.0, 2.0


def potential(film: int, x: float, e: float) -> Potential:
    """P and derivatives at any height; `ValueError` above the table in height or loading."""
    p, px, pe, pxx, pxe, pee, pxxe, pxee, slack = evaluated(film, x, e)
    return Potential(
        p=p, px=px, pe=pe, pxx=pxx, pxe=pxe, pee=pee, pxxe=pxxe, pxee=pxee, slack=slack
    )


def bilinear(rows: tuple[tuple[float, ...], ...], x: float, e: float) -> float:
    """Bilinear value of a coarse table at places x and e within it, in cells."""
    i = min(int(x), int(FIELD_X) - 1)
    j = min(int(e), int(FIELD_E) - 1)
    s = x - float(i)
    t = e - float(j)
    near = rows[i][j] * (1.0 - t) + rows[i][j + 1] * t
    far = rows[i + 1][j] * (1.0 - t) + rows[i + 1][j + 1] * t
    return near * (1.0 - s) + far * s


def extremes(film: int, x: float, e: float) -> tuple[float, float]:
    """Largest l1 l2 and least nominal hoop stress over mu_1 of a cone, to a per cent or so."""
    clipped = min(max(x, LOWEST[film]), HIGHEST[film])
    place_x = (clipped - LOWEST[film]) / (HIGHEST[film] - LOWEST[film]) * FIELD_X
    place_e = min(max(e, 0.0), LOADING[film]) / LOADING[film] * FIELD_E
    return bilinear(FIELD[film], place_x, place_e), bilinear(HOOP[film], place_x, place_e)
