"""Figure 7: force over displacement of slow pull tests, passive and with one cone at 1920 V."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ...report.plot import Axis, Curve, Figure, Plot, Style
from .cached_runs import CachedRuns
from .comparison import Comparison, Row, row
from .figure4 import figure4
from .job import Answer, Job

SPACERS = (20, 25, 30)
ACTIVE = "1920 V"
LINEAR = 0.03
"""Distance from a straight line, of the largest force, that still counts as near to it."""


def figure7(cached_runs: CachedRuns) -> Comparison:
    """Six pull tests; stiffness and straightness of the passive ones."""
    passive = [_job(spacer) for spacer in SPACERS]
    active = [_job(spacer, ACTIVE) for spacer in SPACERS]
    answers = cached_runs.answers([*passive, *active])
    rows = [
        row(
            "figure7.stiffness",
            cached_runs.measured(job, _stiffness),
            job.scenario,
            f"L = {spacer} mm",
        )
        for spacer, job in zip(SPACERS, passive, strict=True)
    ]
    rows += [_straight(spacer, answer) for spacer, answer in zip(SPACERS, answers, strict=False)]
    words = (
        "A rail pulls the spacer from -3.5 to 3.5 mm; slowly enough that only the film's"
        " equilibrium counts, so the loss branches are left out. Active: the top cone at 1920 V.",
        "The paper prints curves and no numbers here. Its stiffness in table 1 comes without the"
        " spacer height that it belongs to.",
    )
    curves = [
        *_curves("passive", "line", answers[: len(SPACERS)]),
        *_curves("active", "dashed", answers[len(SPACERS) :]),
    ]
    figure = Figure(
        "figure7",
        "Force over displacement",
        "Force of the rail on the spacer, by the membrane in every step.",
        [Plot("Pull tests", Axis("displacement (mm)"), Axis("force (N)"), curves)],
    )
    jobs = [*passive, *active]
    failures = [
        f"{job.scenario}{' at ' + ACTIVE if job.hold else ''}: {answer.reason}"
        for job, answer in zip(jobs, answers, strict=True)
        if answer.status != "done"
    ]
    shapes, stopped = figure4(cached_runs)
    title = "Figure 7: quasi-static force; figure 4: shapes"
    return Comparison("figure7", title, words, rows, [figure, shapes], [*failures, *stopped])


def _job(spacer: int, voltage: str = "") -> Job:
    hold = {"membrane.top.voltage": voltage} if voltage else {}
    keep = ("rig.displacement", "membrane.force.value")
    return Job(f"pull-test-L{spacer}", hold=hold, keep=keep, step=0.02, cycles=0)


def _fit(answer: Answer) -> tuple[float, float]:
    """Slope of the straight line of best fit, and the farthest distance from it by the force."""
    x, force = answer.series("displacement"), answer.series("force.value")
    slope, offset = np.polyfit(x, force, 1)
    off = np.abs(force - slope * x - offset).max() / np.abs(force).max()
    return float(slope), float(off)


def _stiffness(answer: Answer) -> float:
    return -_fit(answer)[0]


def _straight(spacer: int, answer: Answer) -> Row:
    reading, scenario = f"L = {spacer} mm", f"pull-test-L{spacer}"
    if answer.status != "done":
        return Row("figure7.linear", "stopped", reading, scenario=scenario, agrees=False)
    off = _fit(answer)[1]
    return Row(
        key="figure7.linear",
        ours=f"within {100 * off:.2g} % of a line",
        reading=reading,
        doubt=math.nan,
        scenario=scenario,
        wall_time=answer.wall_time,
        agrees=off <= LINEAR,
    )


def _curves(kind: str, style: Style, answers: Sequence[Answer]) -> Iterator[Curve]:
    """The rail's force against that of the film, every fifth point."""
    every = slice(None, None, 5)
    for spacer, answer in zip(SPACERS, answers, strict=True):
        if answer.status == "done":
            x, force = answer.series("displacement")[every], answer.series("force.value")[every]
            yield Curve(f"L = {spacer} mm, {kind}", (1e3 * x).tolist(), (-force).tolist(), style)
