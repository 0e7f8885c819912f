"""A scenario over the frequency of its drive: amplitude, phase, or whatever a run shows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..sweep.peak import FINEST, Peak, middles, peak_of, spacing
from .cached_runs import CachedRuns, Measured
from .job import Answer, Job

STEPS_PER_SECOND = 1500
"""Least rate of communication: a mass moves at its own frequency however slow the drive."""

Measure = Callable[[Answer], float]


@dataclass(frozen=True)
class Sweep:
    """How a scenario is swept. `settle` [s] comes before the `cycles` that are looked at."""

    scenario: str
    frequencies: Sequence[float]
    changes: Mapping[str, str] = field(default_factory=dict)
    keep: tuple[str, ...] = ()
    record: tuple[str, ...] = ()
    settle: float = 0.4
    cycles: int = 3
    per_cycle: int = 60

    def job(self, frequency: float) -> Job:
        """The run at one frequency."""
        return Job(
            self.scenario,
            {**self.changes, "amplifier.frequency": f"{frequency!r} Hz"},
            keep=self.keep,
            record=self.record,
            length=max(4, math.ceil(self.settle * frequency)) + self.cycles,
            per_cycle=max(self.per_cycle, math.ceil(STEPS_PER_SECOND / frequency)),
            cycles=self.cycles,
        )


@dataclass(frozen=True)
class FrequencySweep:
    """Answers of a sweep by frequency, those between the given ones where a peak was looked for."""

    sweep: Sweep
    answers: Mapping[float, Answer]

    @property
    def frequencies(self) -> list[float]:
        """All of them, rising."""
        return sorted(self.answers)

    def values(self, measure: Measure) -> list[float]:
        """A measure at each frequency; NaN where the run stopped."""
        return [_value(self.answers[f], measure) for f in self.frequencies]

    def peak(self, measure: Measure, low: float = 0.0, high: float = math.inf) -> Peak | None:
        """The largest value between two frequencies, which is no peak at an end of all."""
        values = {
            f: value
            for f, value in zip(self.frequencies, self.values(measure), strict=True)
            if low <= f <= high
        }
        return peak_of(values)

    def maxima(self, measure: Measure) -> list[Peak]:
        """Places of a given frequency grid where a value stands above both neighbours."""
        places = [(f, v) for f, v in zip(self.frequencies, self.values(measure), strict=True)
                  if math.isfinite(v)]  # fmt: skip
        found = []
        for k in range(1, len(places) - 1):
            near = dict(places[k - 1 : k + 2])
            top = places[k][1]
            if top > places[k - 1][1] and top > places[k + 1][1]:
                peak = peak_of(near)
                found.append(peak if peak is not None else Peak(*places[k]))
        return found

    def crossing(self, measure: Measure, level: float) -> Measured:
        """Frequency at which a measure first rises through a level; NaN where it does not.

        Its doubt is the distance to what every second frequency alone would say.
        """
        places = list(zip(self.frequencies, self.values(measure), strict=True))
        found = _crossing(places, level)
        coarse = [abs(found - _crossing(places[k::2], level)) for k in (0, 1)]
        return Measured(found, max(coarse), self.wall_time)

    def nearest(self, frequency: float) -> float:
        """The frequency that was run nearest to one that may not have been."""
        return min(self.frequencies, key=lambda f: abs(f - frequency))

    def at(self, frequency: float, measure: Measure) -> float:
        """A measure at a frequency that was run."""
        return _value(self.answers[frequency], measure)

    @property
    def wall_time(self) -> float:
        """Seconds that the runs took on their workers, together."""
        return sum(answer.wall_time for answer in self.answers.values())

    @property
    def failures(self) -> list[str]:
        """What stopped runs say."""
        return [
            f"{self.sweep.scenario} at {f:g} Hz: {self.answers[f].reason}"
            for f in self.frequencies
            if self.answers[f].status != "done"
        ]


def frequency_sweeps(
    cached_runs: CachedRuns, sweeps: Sequence[Sweep], measure: Measure, *, refine: bool = True
) -> list[FrequencySweep]:
    """All sweeps together, so that no worker waits; the gaps beside each largest value bisected.

    Down to an eighth of the gap there was, or until the parabola through the top stands still.
    """
    found: list[dict[float, Answer]] = [{} for _ in sweeps]
    wanted = [sorted({float(f) for f in sweep.frequencies}) for sweep in sweeps]
    finest: list[float] = []
    before: list[Peak | None] = [None] * len(sweeps)
    while any(wanted):
        jobs = [(k, f) for k, more in enumerate(wanted) for f in more]
        answers = cached_runs.answers([sweeps[k].job(f) for k, f in jobs])
        for (k, f), answer in zip(jobs, answers, strict=True):
            found[k][f] = answer
        if not refine:
            break
        values = [{f: _value(a, measure) for f, a in sorted(each.items())} for each in found]
        finest = finest or [FINEST * spacing(each) for each in values]
        for k, each in enumerate(values):
            if not wanted[k]:
                continue
            peak, last = peak_of(each), before[k]
            settled = peak is None or (last is not None and peak.like(last, finest[k]))
            wanted[k] = [] if settled else middles(each, finest[k])
            before[k] = peak
    return [FrequencySweep(sweep, each) for sweep, each in zip(sweeps, found, strict=True)]


def doubt(
    cached_runs: CachedRuns, frequency_sweep: FrequencySweep, peak: Peak, measure: Measure
) -> Measured:
    """The top's value with its numerical error: the half step at the frequency nearest to it."""
    nearest_point = cached_runs.measured(
        frequency_sweep.sweep.job(frequency_sweep.nearest(peak.at)), measure
    )
    return Measured(peak.value, nearest_point.doubt, frequency_sweep.wall_time)


def resolution(frequency_sweep: FrequencySweep, peak: Peak) -> float:
    """Half the widest gap between frequencies beside a top [Hz]: how well its place is known."""
    places = np.asarray(frequency_sweep.frequencies)
    k = int(np.clip(np.searchsorted(places, peak.at), 1, len(places) - 1))
    return 0.5 * float(places[k] - places[k - 1])


def _crossing(places: Sequence[tuple[float, float]], level: float) -> float:
    for (f0, v0), (f1, v1) in pairwise(places):
        if v0 < level <= v1:
            return f0 + (level - v0) / (v1 - v0) * (f1 - f0)
    return math.nan


def _value(answer: Answer, measure: Measure) -> float:
    return measure(answer) if answer.status == "done" else math.nan
