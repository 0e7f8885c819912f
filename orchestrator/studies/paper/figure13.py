"""Figure 13: motion at 18 Hz with full wings, and the mechanism's speed ratio."""

from __future__ import annotations

import math

import numpy as np

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns
from .comparison import Comparison, Row
from .job import Answer, Job
from .metrics import harmonics
from .published_values import number

NEAR = 0.05
"""Harmonics of the fundamental that still count as approximately sinusoidal."""


def figure13(cached_runs: CachedRuns) -> Comparison:
    """Two settled cycles of the vehicle."""
    frequency = float(number("figure11.full_wings_frequency").value)
    names = ("linkage.displacement", "linkage.flap_angle", "linkage.transmission")
    job = Job(
        "flapping-full-wings",
        {"amplifier.frequency": f"{frequency!r} Hz"},
        record=(*names, "amplifier.top.voltage", "amplifier.bottom.voltage"),
        keep=names, length=60, per_cycle=100, cycles=2,
    )  # fmt: skip
    (answer,) = cached_runs.answers([job])
    title = "Figure 13: motion at 18 Hz and speed ratio"
    if answer.status != "done":
        return Comparison("figure13", title, (), (), (), [f"{job.scenario}: {answer.reason}"])
    rows = [_sinusoidal(answer, frequency, job.scenario), _ratio(answer, job.scenario)]
    words = (
        "Speed ratio: travel of the slider over angle of the wing, dx/dphi. The paper infers the"
        " angle from the displacement by the same mechanism.",
    )
    return Comparison("figure13", title, words, rows, _drawn(answer))


def _sinusoidal(answer: Answer, frequency: float, scenario: str) -> Row:
    share = harmonics(answer.times, answer.series("displacement"), frequency)
    in_words = f"harmonics are {100 * share:.2g} % of the fundamental"
    return Row(
        key="figure13.sinusoidal",
        ours=in_words,
        reading="",
        doubt=math.nan,
        scenario=scenario,
        wall_time=answer.wall_time,
        agrees=share < NEAR,
    )


def _ratio(answer: Answer, scenario: str) -> Row:
    """Speed ratio at both reversals against the one on the way between them."""
    place, ratio = answer.series("displacement"), 1.0 / answer.series("transmission")
    low, high = ratio[int(np.argmin(place))], ratio[int(np.argmax(place))]
    middle = ratio[int(np.argmin(np.abs(place)))]
    inside = ratio[(place > 0.9 * place.min()) & (place < 0.9 * place.max())]
    in_words = (
        f"{100 * low / middle:.0f} % and {100 * high / middle:.0f} % of that at rest, at the lower"
        " and the upper reversal"
    )
    return Row(
        key="figure13.ratio",
        ours=in_words,
        reading="",
        doubt=math.nan,
        scenario=scenario,
        wall_time=answer.wall_time,
        agrees=bool(max(low, high) < inside.min()),
    )


def _drawn(answer: Answer) -> list[Figure]:
    time = (1e3 * (answer.times - answer.times[0])).tolist()
    place = 1e3 * answer.series("displacement")
    angle = np.degrees(answer.series("flap_angle"))
    order = np.argsort(place)[::2]
    ratio = 1e3 / answer.series("transmission")
    across = Axis("time (ms)")
    motion = Figure(
        "figure13a",
        "Motion at 18 Hz",
        "Displacement of the actuator and flapping angle, the last two cycles.",
        [
            Plot("A: displacement", across, Axis("displacement (mm)"),
                 [Curve("slider", time, place.tolist())]),
            Plot("A: flapping angle", across, Axis("angle (deg)"),
                 [Curve("wing", time, angle.tolist())]),
        ],
    )  # fmt: skip
    speed = Figure(
        "figure13b",
        "Speed ratio over displacement",
        "Travel over angle: the least leverage of the slider's speed is at the reversals.",
        [
            Plot("B: speed ratio", Axis("displacement (mm)"), Axis("travel over angle (mm/rad)"),
                 [Curve("mechanism", place[order].tolist(), ratio[order].tolist())]),
        ],
    )  # fmt: skip
    return [motion, speed]
