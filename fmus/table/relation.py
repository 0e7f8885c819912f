"""A relation of one or two arguments by a polynomial for each cell of its grid.

With t and s from 0 to 1 across a cell,

    y(t, s) = sum_ij a_ij t^i s^j,   i, j = 0 to 3,

which goes through the points and has at each of them the slopes of monotone cubics (Fritsch and
Butland) through the points of its row and of its column; or, linear, the surface through the four
corners. Outside of the grid y is held, or goes on along its slopes at the edge.
"""

from __future__ import annotations

from dataclasses import dataclass

from .data import BOTTOM, COLUMNS, FIRST, HIGH, LOW, PIECES, ROWS, SECOND, TOP

CUBIC = 1.0
LINEAR = 2.0
"""How is interpolated, as the parameter `interpolation` numbers it."""
STOP = 1.0
HOLD = 2.0
EXTEND = 3.0
"""What holds outside of the table, as the parameter `outside` numbers it."""
ROUNDING = 1.0e-12


@dataclass(frozen=True)
class Place:
    """A `cell`, where in it (`t`, `s`), its sides, how far the arguments are beyond the grid."""

    cell: float
    t: float
    s: float
    width: float
    height: float
    beyond: float
    above: float


def cell_of(knots: tuple[float, ...], count: int, x: float) -> int:
    """Number of the cell, of `count`, that holds x."""
    low = 0
    high = count
    while high - low > 1:
        middle = (low + high) // 2
        if x < knots[middle]:
            high = middle
        else:
            low = middle
    return low


def place(first: float, second: float) -> Place:
    """Place of two arguments; outside of the grid the nearest one on its edge."""
    u = min(max(first, LOW), HIGH)
    v = min(max(second, BOTTOM), TOP)
    i = cell_of(FIRST, COLUMNS, u)
    j = cell_of(SECOND, ROWS, v)
    width = FIRST[i + 1] - FIRST[i]
    height = SECOND[j + 1] - SECOND[j]
    return Place(
        cell=float(i * ROWS + j),
        t=(u - FIRST[i]) / width,
        s=(v - SECOND[j]) / height,
        width=width,
        height=height,
        beyond=first - u,
        above=second - v,
    )


def outside(x: float, low: float, high: float) -> bool:
    """Whether an argument is beyond an end by more than rounding."""
    near = ROUNDING * (high - low)
    return x < low - near or x > high + near


def in_second(output: int, cell: int, power: int, s: float) -> float:
    """The polynomial in s that goes with a power of t."""
    k = 4 * power
    return PIECES[output][cell][k] + s * (
        PIECES[output][cell][k + 1]
        + s * (PIECES[output][cell][k + 2] + s * PIECES[output][cell][k + 3])
    )


def in_second_slope(output: int, cell: int, power: int, s: float) -> float:
    """Its slope."""
    k = 4 * power
    return PIECES[output][cell][k + 1] + s * (
        2.0 * PIECES[output][cell][k + 2] + 3.0 * s * PIECES[output][cell][k + 3]
    )


def cubic(output: int, cell: int, t: float, s: float) -> float:
    """y in a cell."""
    return in_second(output, cell, 0, s) + t * (
        in_second(output, cell, 1, s)
        + t * (in_second(output, cell, 2, s) + t * in_second(output, cell, 3, s))
    )


def cubic_first(output: int, cell: int, t: float, s: float) -> float:
    """dy/dt in a cell."""
    return in_second(output, cell, 1, s) + t * (
        2.0 * in_second(output, cell, 2, s) + 3.0 * t * in_second(output, cell, 3, s)
    )


def cubic_second(output: int, cell: int, t: float, s: float) -> float:
    """dy/ds in a cell."""
    return in_second_slope(output, cell, 0, s) + t * (
        in_second_slope(output, cell, 1, s)
        + t * (in_second_slope(output, cell, 2, s) + t * in_second_slope(output, cell, 3, s))
    )


def first_slope_inside(output: int, here: Place, how: float) -> float:
    """dy/du on the grid."""
    cell = int(here.cell)
    if how == LINEAR:
        low = cubic(output, cell, 1.0, 0.0) - cubic(output, cell, 0.0, 0.0)
        high = cubic(output, cell, 1.0, 1.0) - cubic(output, cell, 0.0, 1.0)
        return (low + here.s * (high - low)) / here.width
    return cubic_first(output, cell, here.t, here.s) / here.width


def second_slope_inside(output: int, here: Place, how: float) -> float:
    """dy/dv on the grid."""
    cell = int(here.cell)
    if how == LINEAR:
        low = cubic(output, cell, 0.0, 1.0) - cubic(output, cell, 0.0, 0.0)
        high = cubic(output, cell, 1.0, 1.0) - cubic(output, cell, 1.0, 0.0)
        return (low + here.t * (high - low)) / here.height
    return cubic_second(output, cell, here.t, here.s) / here.height


def value(output: int, here: Place, how: float, beyond: float) -> float:
    """y; `beyond` says what holds outside of the grid."""
    cell = int(here.cell)
    if how == LINEAR:
        low = cubic(output, cell, 0.0, 0.0)
        high = cubic(output, cell, 0.0, 1.0)
        far_low = cubic(output, cell, 1.0, 0.0)
        far_high = cubic(output, cell, 1.0, 1.0)
        near = low + here.s * (high - low)
        y = near + here.t * (far_low + here.s * (far_high - far_low) - near)
    else:
        y = cubic(output, cell, here.t, here.s)
    if beyond == EXTEND:
        y = y + first_slope_inside(output, here, how) * here.beyond
        y = y + second_slope_inside(output, here, how) * here.above
    return y


def first_slope(output: int, here: Place, how: float, beyond: float) -> float:
    """dy/du; 0 where y is held outside of the grid."""
    if beyond != EXTEND and here.beyond != 0.0:
        return 0.0
    return first_slope_inside(output, here, how)


def second_slope(output: int, here: Place, how: float, beyond: float) -> float:
    """dy/dv; 0 where y is held outside of the grid."""
    if beyond != EXTEND and here.above != 0.0:
        return 0.0
    return second_slope_inside(output, here, how)
