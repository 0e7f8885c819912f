"""One function for each construct of the subset; test_constructs.py runs them in both languages."""

from __future__ import annotations

import math
from dataclasses import dataclass

from . import sibling
from .sibling import SCALE as THEIR_SCALE
from .sibling import SHARED, free, scaled

SCALE = 7.0
COUNT = 3
ROW = (1.5, -2.5, 4.0)
ROWS = ((1.0, 2.0, 3.0), (-4.0, 5.5, 6.0), (0.1, 1.0e-300, -1.0e300))
CUBE = (ROWS, ((7.0, 8.0, 9.0), (10.0, 11.0, 12.0), (13.0, 14.0, 15.0)))

Mixed = tuple[int, float, bool]
Pair = tuple[float, float]


@dataclass(frozen=True)
class Base:
    """Fields that others take over."""

    first: float


@dataclass(frozen=True)
class Pose(Base):
    """A record with names that C has taken."""

    default: float
    x: float


@dataclass(frozen=True)
class Whole:
    """A record of records."""

    near: Pose
    size: float


# ---- numbers ----


def add(a: float, b: float) -> float:
    return a + b - (a - b) + -a


def groups(a: float, b: float) -> float:
    return a - (b - a) + (a * b) * (b * a) - -(a + b)


def ratio(a: float, b: float) -> float:
    return a / b


def ratios(a: float, b: float) -> float:
    return a / b / 3.0 / (b / a)


def constant_ratio(a: float, b: float) -> float:
    return a / (2.0 * math.pi) + b / SCALE + a / -4.0


def floored(a: float, b: float) -> float:
    return a // b


def modulo(a: float, b: float) -> float:
    return a % b


def plus(a: float, b: float) -> float:
    return +a + +b


def augmented(a: float, b: float) -> float:
    total = a
    total += b
    total -= 0.5
    total *= a
    total /= b
    return total


def annotated(a: float, b: float) -> float:
    total: float = a * b
    return total


# ---- whole numbers ----


def whole(a: float, b: float) -> int:
    i = int(a)
    j = int(b)
    return (i + j) - min(i, j)


def whole_floored(i: int, j: int) -> int:
    return i // j


def whole_modulo(i: int, j: int) -> int:
    return i % j


def whole_extremes(i: int, j: int) -> int:
    return max(i, j) - min(i, j) * 2 + -i


def whole_compared(i: int, j: int) -> bool:
    return i <= j < 5 or i == 7 or j != i


def mixed(i: int, a: float) -> float:
    return i * a + a / (float(i) + 0.5) - COUNT * 0.25


def converted(i: int, a: float) -> float:
    return float(i) * 0.1 + float(int(a)) + float(a) + float(2)


def down(a: float, b: float) -> float:
    return float(math.floor(a)) - (b - math.floor(b))


def up(a: float, b: float) -> float:
    count = 1.0
    if b > 0.0:
        count = max(count, math.ceil(a))
    return float(count) + -float(math.ceil(b))


def rounded_and_compared(a: float, b: float) -> bool:
    low = math.floor(a)
    return low < b and low == a


# ---- truth ----


def chained(a: float, b: float) -> bool:
    return a < b <= 2.0 * a < 1.0 / b


def chained_once(a: float, b: float) -> bool:
    return 0.0 < math.sqrt(a) < b


def negated(a: float, b: float) -> bool:
    return not a > b and not (a == b or b != b)


def short_and(a: float, b: float) -> bool:
    return b != 0.0 and a / b > 1.0 and math.log(a) > 0.0


def short_or(a: float, b: float) -> bool:
    return b == 0.0 or a / b > 1.0 or (a < 0.0 and b < 0.0)


def hoisted_and(a: float, b: float) -> bool:
    return a > 0.0 and math.sqrt(b) + 1.0 / a > 2.0


def hoisted_or(a: float, b: float) -> bool:
    return a > 0.0 or math.sqrt(b) + 1.0 / a > 2.0


def as_variables(a: float, b: float) -> bool:
    left = a > b
    right = not left or b > 0.0
    return left if right else a < 0.0


def told(flag: bool, a: float) -> float:
    return a if flag else -a


def flags(flag: bool, other: bool) -> bool:
    return (flag and not other) or (other and not flag)


# ---- choices ----


def choice(a: float, b: float) -> float:
    return a if a > b else 2.0 * b if b > 0.0 else -1.0


def hoisted_choice(a: float, b: float) -> float:
    return math.sqrt(a) + 1.0 / b if a > b else math.exp(b) - 1.0 / a


def smaller(a: float, b: float) -> float:
    return min(a, b)


def larger(a: float, b: float) -> float:
    return max(a, b)


def three(a: float, b: float) -> float:
    return max(a, b, 0.0) - min(0.5, a, b, -a)


def branches(a: float, b: float) -> float:
    if a > b:
        found = 1.0
    elif a == b:
        found = 2.0
        other = a
        found = found + other
    elif math.sqrt(a) > 1.0 / b:
        found = 3.0
    else:
        if b > 0.0:
            return 4.0
        found = 5.0
    return found


# ---- loops ----


def counted(n: int, a: float) -> float:
    total = 0.0
    for i in range(n):
        if i == 7:
            break
        if i % 2 == 1:
            continue
        for j in range(i):
            total = total + float(j) * a
    return total


def bound_once(n: int, a: float) -> float:
    total = a
    for _ in range(n + 1):
        n = n - 1
        total = total + float(n)
    return total


def halved(a: float, b: float) -> float:
    count = 0.0
    while math.fabs(a) > 1.0 and count < 50.0:
        a = 0.5 * a + b * 0.0
        count = count + 1.0
    return count


def hoisted_while(a: float, b: float) -> float:
    count = 0.0
    while math.sqrt(a) + 1.0 / b > 3.0:
        a = a - 1.0
        count = count + 1.0
        if count > 20.0:
            break
    return count


def endless(a: float, b: float) -> float:
    count = 0.0
    while True:
        pass
        if count > 5.0 or not a > b:
            return count
        count = count + 1.0


def newton(a: float, b: float) -> float:
    x = 1.0
    for _ in range(20):
        change = (x * x - a) / (2.0 * x)
        x = x - change
        if math.fabs(change) < 1e-12:
            return x
    raise ValueError("no root is found")


# ---- tuples, tables ----


def two(a: float, b: float) -> tuple[float, float]:
    return a / b, b


def unpacked(a: float, b: float) -> float:
    first, _ = two(a, b)
    second = two(b, a)[0]
    _, third = two(1.0, b)
    return first - second + third


def swapped(a: float, b: float) -> float:
    a, b = b, a + b
    b, a = a, b
    c, d = a * b, 1.0
    return a - 2.0 * b + c + d


def picked(i: int, a: float) -> float:
    row = (a, 2.0 * a, -a, 4.0)
    return row[i] + row[-1] + row[0]


def several(i: int, a: float) -> Mixed:
    return i + 1, a / 2.0, a > 0.0


def taken(at: Mixed) -> float:
    i, a, good = at
    return a + float(i) if good else at[1] - 1.0


def mixed_tuple(i: int, a: float) -> float:
    return taken(several(i, a)) + several(i, a)[1]


def looked_up(i: int, j: int) -> float:
    return ROWS[i][j] + ROW[j] + ROW[-1] + ROWS[-2][1]


def deep(i: int, j: int) -> float:
    return CUBE[1][i][j] - CUBE[j][0][i]


def passed_row(row: tuple[float, ...], i: int) -> float:
    return row[i] * 2.0


def passed_rows(rows: tuple[tuple[float, ...], ...], i: int, j: int) -> float:
    row = rows[i]
    return rows[i][j] + row[j] + rows[-1][0]


def handed_on(i: int, j: int) -> float:
    kept = CUBE[i]
    here = ROWS[0]
    return passed_rows(kept, j, i) + passed_row(ROWS[j], i) + passed_rows(SHARED, i, j) + here[i]


# ---- records ----


def built(a: float, b: float) -> float:
    pose = Pose(first=a, default=b / a, x=math.sqrt(b))
    return pose.first + pose.default * pose.x


def moved(pose: Pose, by: float) -> Pose:
    if by > 0.0:
        pose = Pose(first=pose.x, default=pose.default, x=by)
    return pose


def sized(pose: Pose) -> float:
    return pose.first - pose.x * pose.default


def same(pose: Pose) -> Pose:
    return pose


def handed(a: float, b: float) -> float:
    pose = Pose(x=a, first=b, default=1.0)
    pose = moved(pose, b)
    pose = moved(pose, a)
    return (
        sized(pose)
        + sized(moved(pose, 1.0))
        + sized(Pose(first=a, default=b, x=2.0))
        + same(pose).x
    )


def nested(a: float, b: float) -> float:
    whole = Whole(near=Pose(first=a, default=2.0, x=b), size=a)
    near = whole.near
    return sized(whole.near) + near.x + whole.near.default + inner(whole)


def inner(whole: Whole) -> float:
    near = whole.near
    return near.first * whole.size + sized(whole.near)


def selected(a: float, b: float) -> float:
    pose = Pose(first=a, default=b, x=0.0) if a > b else moved(Pose(first=1.0, default=b, x=a), b)
    return sized(pose)


# ---- calls ----


def defaults(a: float, b: float) -> float:
    return scaled(a) + scaled(b, 3.0) + scaled(a, shift=b) + scaled(shift=a, x=b, by=a)


def chosen(a: float, b: float) -> float:
    return sibling.chosen(a) + sibling.posed(b).far


def through(a: float, b: float) -> float:
    return chosen(a, b) + free(b) + sibling.free(a) + THEIR_SCALE + sibling.SCALE + SCALE


def hidden(a: float, b: float) -> float:
    sqrt = a
    free = sqrt + 1.0
    return free + sibling.free(b)


def words(a: float, b: float) -> float:
    double = a
    default = b
    fault = double + 1.0
    quotient = fault / default
    kept1 = quotient
    within = kept1 + ROW[int(a)]
    return larger(within, fabs(b))


def fabs(x: float) -> float:
    return math.fabs(x) + 1.0


def unused(a: float, b: float) -> float:
    spare = 1.0 / b  # noqa: F841
    _ = math.sqrt(a)
    nothing = 3.0  # noqa: F841
    return a


def for_effect(a: float, b: float) -> float:
    two(a, b)
    return b


# ---- which error comes first ----


def sum_order(a: float, b: float) -> float:
    return math.sqrt(a) + 1.0 / b + math.exp(a * b)


def product_order(a: float, b: float) -> float:
    return (1.0 / b + math.log(a)) * math.sqrt(b)


def argument_order(a: float, b: float) -> float:
    return larger(1.0 / b, math.sqrt(a)) - two(math.log(a), 1.0 / a)[0]


def keyword_order(a: float, b: float) -> float:
    return scaled(shift=math.sqrt(a), x=1.0 / b)


def record_order(a: float, b: float) -> float:
    return sized(Pose(x=1.0 / b, default=math.log(a), first=math.sqrt(b)))


def tuple_order(a: float, b: float) -> float:
    row = (math.sqrt(a), 1.0 / b, math.log(b))
    return row[1]


def index_order(a: float, b: float) -> float:
    return ROWS[int(a)][int(1.0 / b)]


def raised(a: float, b: float) -> float:
    if a > b:
        raise ValueError('"quoted" \\ and ??/ and 50 % of µ*/')
    return math.sqrt(a)


# ---- mathematics ----


def square(a: float, b: float) -> float:
    return math.pow(a, 2.0) + math.pow(2.0, b) + math.pow(a, 0.5)


def power(a: float, b: float) -> float:
    return math.pow(a, b)


def known(a: float, b: float) -> float:
    return math.exp(1.0) + math.sin(0.5) + math.log(3.0) * a + math.tanh(0.3) + math.cos(1e22) + b


def signs(a: float, b: float) -> float:
    return math.copysign(a, b) + math.fabs(b)


def angle(a: float, b: float) -> float:
    return math.atan2(a, b)


def functions(a: float, b: float) -> float:
    return math.atan(a) + math.tanh(b) - math.asinh(a)
