"""Shapes of the cones: the points that `profile` gives out, as smooth outlines; figure 4."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns
from .job import Answer, Job
from .published_values import given

Values = NDArray[np.float64]

POINTS = 6
NODES = 0.5 * (1.0 - np.cos(np.pi * np.arange(POINTS + 2) / (POINTS + 1)))
"""Both rims and the points between, in s = ln(R/a)/ln(b/a): see the README of `profile`."""

SCENARIO, SPACER = "shape-test", 30e-3
"""The scenario of the rail, and the height of its spacer [m]: a cone is half of it high at rest."""

HEIGHTS = (8, 12, 16, 20)
"""Heights of the top cone that are shown [mm]."""

ACTIVE = "1920 V"


def outline(
    radii: Values, axial: Values, inner: tuple[float, float], outer: float, count: int = 12
) -> tuple[Values, Values]:
    """One half of a cone, (count,) radii and axial positions from the inner rim to the outer.

    The polynomial of degree seven through six points (6,), the inner rim (radius, axial) and
    the outer one at axial 0.
    """
    at = 0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1)))
    r = BarycentricInterpolator(NODES, np.array([inner[0], *radii, outer]))(at)
    z = BarycentricInterpolator(NODES, np.array([inner[1], *axial, 0.0]))(at)
    return r, z


def points(answer: Answer, cone: str, k: int) -> tuple[Values, Values]:
    """Radii (6,) and axial positions (6,) of a cone, `top` or `bottom`, at recorded time k."""
    radii, axial = (
        np.array([answer.series(f"{cone}_shape.{way}_{n + 1}")[k] for n in range(POINTS)])
        for way in ("radius", "axial")
    )
    return radii, axial


def figure4(cached_runs: CachedRuns) -> tuple[Figure, list[str]]:
    """Meridians of the top cone at four heights, passive and active; and what stopped."""
    jobs = [_job({}), _job({"profile.top.voltage": ACTIVE})]
    answers = cached_runs.answers(jobs)
    across, up = Axis("radius (mm)"), Axis("axial position (mm)", least=0.0, most=21.0)
    plots = [
        Plot(title, across, up, _meridians(answer))
        for title, answer in zip(("A: passive", f"B: {ACTIVE}"), answers, strict=True)
        if answer.status == "done"
    ]
    figure = Figure(
        "figure4",
        "Shape of a cone",
        "Meridians r(R), z(R) of the top cone at four heights; scenario shape-test. Passive it is"
        " hollow; the voltage stretches the film where both rims hold it, so that it fills out.",
        plots,
    )
    return figure, [f"{SCENARIO}: {a.reason}" for a in answers if a.status != "done"]


def _meridians(answer: Answer) -> list[Curve]:
    place = answer.series("rig.displacement") + 0.5 * SPACER
    curves = []
    for height in HEIGHTS:
        k = int(np.argmin(np.abs(place - 1e-3 * height)))
        rim = (float(given("bench_inner_radius")), float(place[k]))
        outer = float(given("bench_outer_radius"))
        r, z = outline(*points(answer, "top", k), rim, outer, 40)
        curves.append(Curve(f"{height} mm", (1e3 * r).tolist(), (1e3 * z).tolist()))
    return curves


def _job(hold: dict[str, str]) -> Job:
    keep = ("rig.displacement", "profile.top_shape.*")
    return Job(SCENARIO, hold=hold, keep=keep, step=0.02, cycles=0)
