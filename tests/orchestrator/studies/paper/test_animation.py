"""The animation: links that keep their lengths, cones that meet their rims, a cycle that closes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from orchestrator.report.animation import Animation, Body
from orchestrator.studies.paper.animation import INNER, flight
from orchestrator.studies.paper.cached_runs import CachedRuns
from orchestrator.studies.paper.figure4 import NODES, figure4, outline
from orchestrator.studies.paper.job import Answer, Job
from orchestrator.studies.paper.linkage_pose import joints, links
from orchestrator.studies.paper.published_values import given
from orchestrator.studies.run_cache import RunCache

KEPT = ("linkage.displacement", "linkage.flap_angle")


@pytest.fixture(scope="module")
def cached_runs(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CachedRuns]:
    with CachedRuns(library, RunCache(tmp_path_factory.mktemp("runs")), workers=1) as made:
        yield made


@pytest.fixture(scope="module")
def flown(cached_runs: CachedRuns) -> Answer:
    job = Job("flapping-full-wings", keep=KEPT, length=12, per_cycle=60, cycles=2)
    (answer,) = cached_runs.answers([job])
    return answer


@pytest.fixture(scope="module")
def film(cached_runs: CachedRuns) -> Animation:
    item = flight(cached_runs)
    assert not item.failures
    (made,) = item.extras
    assert isinstance(made, Animation)
    return made


def test_links_keep_their_lengths(flown: Answer) -> None:
    """The flap angle is the run's, so the coupler's length is a check and no construction."""
    at = joints(links(), flown.series("linkage.displacement"), flown.series("flap_angle"))
    sizes = {
        ("slider", "crank"): links().conrod,
        ("pivot", "crank"): links().crank,
        ("pivot", "arm"): links().arm,
        ("arm", "rocker"): links().coupler,
        ("root", "rocker"): links().rocker,
    }
    assert np.ptp(flown.series("flap_angle")) > 0.5
    for (one, other), length in sizes.items():
        far = np.hypot(*(a - b for a, b in zip(at[one], at[other], strict=True)))
        np.testing.assert_allclose(far, length, rtol=2e-6)


def test_the_neutral_pose_is_square() -> None:
    at = joints(links(), np.zeros(1), np.zeros(1))
    assert at["crank"] == (pytest.approx(-links().crank), pytest.approx(0.0, abs=1e-12))
    assert at["arm"] == (pytest.approx(0.0, abs=1e-12), pytest.approx(links().arm))
    assert at["rocker"] == (pytest.approx(links().coupler), pytest.approx(links().arm))


def test_an_outline_goes_through_its_points_and_rims() -> None:
    """A truncated cone is its own polynomial."""
    s = NODES[1:-1]
    r, z = outline(1.0 + s, 3.0 * (1.0 - s), (1.0, 3.0), 2.0, 9)
    assert (r[0], z[0], r[-1], z[-1]) == pytest.approx((1.0, 3.0, 2.0, 0.0))
    np.testing.assert_allclose(z, 3.0 * (2.0 - r), atol=1e-12)


def body(film: Animation, name: str) -> Body:
    return next(b for view in film.views for b in view.bodies if b.name == name)


def test_frames_close_a_cycle(film: Animation) -> None:
    assert len(film.times) == 121
    for view in film.views:
        for each in view.bodies:
            if len(each.x) > 1:
                assert len(each.x) == len(each.y) == 121
            np.testing.assert_allclose(each.x[0], each.x[-1], atol=0.1)
            np.testing.assert_allclose(each.y[0], each.y[-1], atol=0.1)


def test_cones_hang_between_frames_and_rod(film: Animation) -> None:
    """Outer rims stand still; the spacer keeps the inner rims apart, and the rod stands on it."""
    names = ("top cone", "bottom cone", "spacer", "rod")
    top, bottom, spacer, rod = (body(film, name) for name in names)
    outer = 1e3 * float(given("outer_radius"))
    for cone in (top, bottom):
        assert {(frame[0], frame[-1]) for frame in cone.x} == {(-outer, outer)}
        assert len({y[0] for y in cone.y}) == 1
    middle = len(top.x[0]) // 2
    assert top.x[0][middle] == pytest.approx(1e3 * INNER)
    for upper, lower, between, mast in zip(top.y, bottom.y, spacer.y, rod.y, strict=True):
        assert upper[middle] - lower[middle] == pytest.approx(1e3 * float(given("spacer")))
        assert between == pytest.approx([lower[middle], upper[middle]])
        assert upper[middle] == pytest.approx(mast[0])


def test_nothing_leaves_its_window(film: Animation) -> None:
    for view in film.views:
        x0, y0, x1, y1 = view.window
        for each in view.bodies:
            assert x0 < min(map(min, each.x)) and max(map(max, each.x)) < x1
            assert y0 < min(map(min, each.y)) and max(map(max, each.y)) < y1


def test_every_name_points_at_a_body(film: Animation) -> None:
    told = film.data()["views"]
    for view, shown in zip(film.views, told, strict=True):
        for label, drawn in zip(view.labels, shown["labels"], strict=True):
            found = view.bodies[drawn["body"]]
            assert found.name == label.body
            assert max(label.points) < len(found.x[0])
    texts = {label.text for view in film.views for label in view.labels}
    assert texts >= {"wing", "linkage", "film", "spacer"}


def test_colour_follows_the_voltages(film: Animation) -> None:
    """Half a cycle apart: one is full while the other is empty."""
    top, bottom = body(film, "top cone").level, body(film, "bottom cone").level
    assert max(top) > 0.98 and min(top) < 0.02
    quarter = len(top) // 4
    assert top[quarter] > 0.98 and bottom[quarter] < 0.02


def test_the_wing_is_rigid_and_attached(film: Animation) -> None:
    wing, rocker = body(film, "wing"), body(film, "rocker")
    for x, y, rx, ry in zip(wing.x, wing.y, rocker.x, rocker.y, strict=True):
        assert (x[0], y[0]) == pytest.approx((rx[1], ry[1]), abs=1e-6)
        assert math.hypot(x[1] - x[0], y[1] - y[0]) == pytest.approx(40.0)


def test_the_cones_bulge_under_voltage(cached_runs: CachedRuns) -> None:
    """Radii are monotone along a meridian, and larger in its middle when active."""
    figure, stopped = figure4(cached_runs)
    assert not stopped
    hollow, full = figure.plots
    for passive, active in zip(hollow.curves, full.curves, strict=True):
        assert all(a < b for a, b in pairwise(passive.x))
        assert passive.x[0] == pytest.approx(4.0)
        heights = np.interp(10.0, passive.x, passive.y), np.interp(10.0, active.x, active.y)
        assert heights[1] > heights[0] + 0.05
