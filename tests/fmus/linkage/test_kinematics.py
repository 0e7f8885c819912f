"""The linkage against the table of a feasibility study, and its own derivatives."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest

from fmus.linkage import physics
from fmus.linkage.kinematics import Geometry, closed_form, flap, usable_range

PRINTED = Geometry(conrod=8e-3, crank=4e-3, arm=8.5e-3, coupler=18e-3, rocker=5e-3)


@pytest.mark.parametrize(
    ("travel", "up", "down", "upper_slope", "lower_slope"),
    [
        (1.230e-3, 31.54, -31.49, 500, 497),
        (1.559e-3, 41.56, -41.44, 569, 566),
        (1.749e-3, 48.09, -47.96, 636, 638),
        (2.036e-3, 59.86, -60.18, 821, 905),
    ],
)
def test_strokes_of_the_printed_lengths(
    travel: float, up: float, down: float, upper_slope: float, lower_slope: float
) -> None:
    above, below = closed_form(PRINTED, travel), closed_form(PRINTED, -travel)
    assert math.degrees(above[0]) == pytest.approx(up, abs=0.01)
    assert math.degrees(below[0]) == pytest.approx(down, abs=0.01)
    assert above[1] == pytest.approx(upper_slope, abs=0.6)
    assert below[1] == pytest.approx(lower_slope, abs=0.6)


def test_the_neutral_pose_has_the_product_of_the_ratios() -> None:
    assert closed_form(PRINTED, 0.0)[1] == pytest.approx((1 / 4e-3) * (8.5 / 5.0))


@pytest.mark.parametrize("x", [k * 2e-4 for k in range(-20, 22)])
def test_derivatives_are_those_of_the_angle(x: float) -> None:
    """Inside the usable range and in the continuation beyond it."""
    r = usable_range(PRINTED)
    h = 2e-7
    low, here, high = (flap(PRINTED, r, x + s * h) for s in (-1, 0, 1))
    assert (high[0] - low[0]) / (2 * h) == pytest.approx(here[1], rel=2e-6)
    assert (high[1] - low[1]) / (2 * h) == pytest.approx(here[2], rel=1e-4, abs=50.0)


def test_random_lengths_are_usable_and_monotone() -> None:
    rng = random.Random(3)
    for _ in range(60):
        lengths = [v * rng.uniform(0.7, 1.3) for v in (8e-3, 4e-3, 8.5e-3, 18e-3, 5e-3)]
        g = Geometry(*lengths)
        r = usable_range(g)
        assert r.upper > 0.8e-3
        assert r.lower < -0.8e-3
        grid = [r.lower + (r.upper - r.lower) * k / 50 for k in range(51)]
        angles = [flap(g, r, x)[0] for x in grid]
        assert all(b > a for a, b in pairwise(angles))


def test_stops_beyond_the_singularity_are_refused() -> None:
    with pytest.raises(ValueError, match="singularity"):
        physics.initial(physics.Params(stop_travel=2.5e-3), physics.Input(), 0.0)
