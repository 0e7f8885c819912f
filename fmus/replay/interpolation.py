"""Recorded columns at any time: value, slope, and the curvatures that make means exact.

Between two knots a column is a polynomial of the time s from the earlier one. With y' the slope at
the end of a step of size h, the coefficients of s^2 in the laws that hold from there,

    y(t + s)   = y + y' s + k s^2,         k = 3 (mean(y) - y + y' h / 2) / h^2
    y^2(t + s) = y^2 + 2 y y' s + k s^2,   k = 3 (mean(y^2) - y^2 + y y' h) / h^2

have the means over that step exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .data import (
    BEGIN,
    COUNT,
    END,
    EVENTS,
    FIRST,
    GRAIN,
    KNOTS,
    LAST,
    PERIOD,
    PIECES,
    POWERS,
    SECOND,
    TURNS,
)

NEVER = 1.0e30
HOLD = 1.0
ZERO = 2.0
STOP = 3.0
"""What holds outside of the record, as the parameters `before` and `after` number it."""

NODE_0 = 0.06943184420297371
NODE_1 = 0.33000947820757187
WEIGHT_0 = 0.17392742256872692
WEIGHT_1 = 0.32607257743127308
"""Gauss and Legendre's four nodes on 0 to 1: exact for the square of a cubic."""


@dataclass(frozen=True)
class Place:
    """Where a time is: in which `piece`, how far from its knot (`s` [s]), after how many `turns` of
    the period, and as `time` [s] within the record; `late` [s] is how far behind its end."""

    piece: float
    s: float
    turns: float
    time: float
    late: float


def place(time: float) -> Place:
    """Place of a time in the record's clock."""
    turns = 0.0
    if PERIOD > 0.0:
        turns = float(math.floor((time - BEGIN + GRAIN) / PERIOD))
    inner = time - turns * PERIOD
    low = int(0.0)
    high = int(COUNT)
    while low + 1 < high:
        middle = int(0.5 * float(low + high))
        if KNOTS[0][middle] <= inner + GRAIN:
            low = middle
        else:
            high = middle
    return Place(
        piece=float(low), s=inner - KNOTS[0][low], turns=turns, time=inner, late=inner - END
    )


def moved(at: Place, time: float) -> Place:
    """The same piece, looked at from another time: one step may end where a piece does."""
    k = int(at.piece)
    inner = time - at.turns * PERIOD
    return Place(piece=at.piece, s=inner - KNOTS[0][k], turns=at.turns, time=at.time, late=at.late)


def polynomial(j: int, k: int, s: float) -> float:
    """Column `j` in piece `k`."""
    total = 0.0
    for i in range(POWERS):
        total = PIECES[j][k][POWERS - 1 - i] + s * total
    return total


def outside(how: float, value: float) -> float:
    """What holds beyond an end."""
    return 0.0 if how == ZERO else value


def value(j: int, at: Place, before: float, after: float) -> float:
    """Column `j` at a place."""
    if at.time < BEGIN - GRAIN:
        return outside(before, PIECES[j][0][0])
    if PERIOD <= 0.0 and at.late > -GRAIN:
        return outside(after, LAST[0][j]) if at.late > GRAIN else LAST[0][j]
    return polynomial(j, int(at.piece), at.s)


def slope(j: int, at: Place) -> float:
    """Slope of column `j` [1/s] by the piece of a place; zero beyond the ends."""
    if at.time < BEGIN - GRAIN or (PERIOD <= 0.0 and at.late > 0.0):
        return 0.0
    k = int(at.piece)
    total = 0.0
    for i in range(POWERS - 1):
        power = POWERS - 1 - i
        total = float(power) * PIECES[j][k][power] + at.s * total
    return total


def edge(time: float, size: float) -> Place:
    """Whose slope counts: at the end of a step the piece that ends there, else what begins."""
    if size > 0.0 or (PERIOD <= 0.0 and time > END - GRAIN):
        return moved(place(time - 2.0 * GRAIN), time)
    return place(time)


def integral(j: int, at: Place, before: float, after: float) -> float:
    """Integral of column `j` from the start of the record."""
    turned = at.turns * FIRST[j][COUNT]
    if at.time < BEGIN:
        return turned + (at.time - BEGIN) * outside(before, PIECES[j][0][0])
    if at.late >= 0.0:
        return turned + FIRST[j][COUNT] + at.late * outside(after, LAST[0][j])
    k = int(at.piece)
    total = 0.0
    for i in range(POWERS):
        power = POWERS - 1 - i
        total = PIECES[j][k][power] / (float(power) + 1.0) + at.s * total
    return turned + FIRST[j][k] + at.s * total


def squared(j: int, at: Place, before: float, after: float) -> float:
    """Integral of the square of column `j` from the start of the record."""
    turned = at.turns * SECOND[j][COUNT]
    if at.time < BEGIN:
        held = outside(before, PIECES[j][0][0])
        return turned + (at.time - BEGIN) * held * held
    if at.late >= 0.0:
        held = outside(after, LAST[0][j])
        return turned + SECOND[j][COUNT] + at.late * held * held
    k = int(at.piece)
    a = polynomial(j, k, NODE_0 * at.s)
    b = polynomial(j, k, NODE_1 * at.s)
    c = polynomial(j, k, (1.0 - NODE_1) * at.s)
    d = polynomial(j, k, (1.0 - NODE_0) * at.s)
    whole = WEIGHT_0 * (a * a + d * d) + WEIGHT_1 * (b * b + c * c)
    return turned + SECOND[j][k] + at.s * whole


def curvature(
    j: int, rate: float, start: Place, at: Place, size: float, before: float, after: float
) -> float:
    """Coefficient of s^2 in column `j` after a step of a size; zero before the first one."""
    if size <= 0.0:
        return 0.0
    mean = (integral(j, at, before, after) - integral(j, start, before, after)) / size
    y = value(j, at, before, after)
    return 3.0 * (mean - y + 0.5 * rate * size) / (size * size)


def square_curvature(
    j: int, rate: float, start: Place, at: Place, size: float, before: float, after: float
) -> float:
    """Coefficient of s^2 in the square of column `j` after a step of a size."""
    if size <= 0.0:
        return 0.0
    mean = (squared(j, at, before, after) - squared(j, start, before, after)) / size
    y = value(j, at, before, after)
    return 3.0 * (mean - y * y + y * rate * size) / (size * size)


def next_event(time: float) -> float:
    """Time of the next discontinuity in the record's clock [s]; `NEVER` where there is none."""
    turns = 0.0
    if PERIOD > 0.0:
        turns = float(math.floor((time - BEGIN + GRAIN) / PERIOD))
    shift = turns * PERIOD
    for i in range(TURNS):
        if EVENTS[0][i] > time - shift + GRAIN:
            return EVENTS[0][i] + shift
    if PERIOD > 0.0 and TURNS > 0:
        return EVENTS[0][0] + shift + PERIOD
    return NEVER
