"""Two runs side by side: their metrics, and how far each variable of one is from the other's."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from math import isclose, isfinite, nan

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, nearest, printable
from ..units import UnitError, factor, si_value
from .metrics import Metric, metrics
from .recorded import Recorded
from .texts import texts_at


@dataclass(frozen=True)
class Difference:
    """Second run minus first one of a variable, over the time that both have.

    `largest` is the largest absolute difference, `at` [s] where it is, `rms` the root of the mean
    square, in `unit`; `relative` is `largest` over the first run's largest absolute value.
    """

    name: str
    unit: str
    largest: float
    at: float
    rms: float
    relative: float


@dataclass(frozen=True)
class TextDifference:
    """How long [s] a text of the two runs differs, and from when on [s]; NaN where it never does.

    `ours` and `theirs` are what the two say then.
    """

    name: str
    apart: float
    first: float
    ours: str
    theirs: str


@dataclass(frozen=True)
class MetricPair:
    """A metric of both runs; None where one of them has none of that name."""

    name: str
    one: Metric | None
    other: Metric | None

    @property
    def change(self) -> float:
        """Second value minus first one, over the size of the first; NaN where there is none."""
        if self.one is None or self.other is None or self.one.unit != self.other.unit:
            return nan
        rise = self.other.value - self.one.value
        return rise / abs(self.one.value) if self.one.value else (0.0 if rise == 0.0 else nan)


SettingPairs = dict[str, tuple[str | None, str | None]]
"""Settings by name that are not alike; None where a scenario leaves one as the FMU has it."""


@dataclass(frozen=True)
class Comparison:
    """Two runs: metrics, differences with the largest relative one first, and what only one has."""

    begin: float
    end: float
    metrics: list[MetricPair]
    differences: list[Difference]
    texts: list[TextDifference]
    missing: tuple[list[str], list[str]]
    """Variables that the first run lacks, and the second one."""
    settings: SettingPairs


def compared(
    one: Recorded, other: Recorded, *, patterns: Sequence[str] | None = None
) -> Comparison:
    """Compare two runs at the first one's times, the second interpolated linearly between rows.

    `patterns` choose variables. `InputError` where a pattern matches nothing that both have, or
    the runs have no time in common.
    """
    begin = max(float(one.times[0]), float(other.times[0]))
    end = min(float(one.times[-1]), float(other.times[-1]))
    inside = (one.times >= begin) & (one.times <= end)
    if not inside.any():
        raise InputError(
            f"the results have no time in common: one is from {one.times[0]:g} to"
            f" {one.times[-1]:g} s, the other from {other.times[0]:g} to {other.times[-1]:g} s"
        )
    common = [name for name in one.series if name in other.series]
    texts = [name for name in one.texts if name in other.texts]
    wanted = chosen([*common, *texts], patterns)
    found = [_difference(one, other, name, inside) for name in common if name in wanted]
    found.sort(key=lambda each: -each.relative if isfinite(each.relative) else 0.0)
    missing = tuple(
        [name for name in has.series if name not in lacks.series]
        + [name for name in has.texts if name not in lacks.texts]
        for lacks, has in ((one, other), (other, one))
    )
    return Comparison(
        begin,
        end,
        list(_pairs(one, other)),
        found,
        [_text_difference(one, other, name, begin, end) for name in texts if name in wanted],
        (missing[0], missing[1]),
        differing(one.settings, other.settings),
    )


def chosen(common: Sequence[str], patterns: Sequence[str] | None) -> list[str]:
    """Those that match a pattern, or all; `InputError` where a pattern matches none."""
    for pattern in patterns or ():
        if not any(fnmatchcase(name, pattern) for name in common):
            raise InputError(
                f"--variable {printable(pattern)!r}: not in both results;"
                f" {nearest(pattern, common)}"
            )
    return [n for n in common if not patterns or any(fnmatchcase(n, p) for p in patterns)]


def differing(one: Mapping[str, str], other: Mapping[str, str]) -> SettingPairs:
    """Settings that are not alike in two results; none where one of them keeps no settings."""
    if not (one and other):
        return {}
    pairs = {name: (one.get(name), other.get(name)) for name in dict.fromkeys([*one, *other])}
    return {name: pair for name, pair in pairs.items() if not _alike(*pair)}


def _alike(one: str | None, other: str | None) -> bool:
    """Whether two texts mean the same: `0.1 ms` and `0.0001 s` do."""
    if one is None or other is None or one == other:
        return one == other
    unit = re.sub(r"^[-+.\deE]*", "", other).strip() or "1"
    try:
        return isclose(si_value(one, unit), si_value(other, unit), rel_tol=1e-9)
    except UnitError:
        return False


def _pairs(one: Recorded, other: Recorded) -> Iterator[MetricPair]:
    """Metrics by name, those of the first run first."""
    ours, theirs = ({metric.name: metric for metric in metrics(data)} for data in (one, other))
    for name in dict.fromkeys([*ours, *theirs]):
        yield MetricPair(name, ours.get(name), theirs.get(name))


def _difference(one: Recorded, other: Recorded, name: str, inside: NDArray[np.bool_]) -> Difference:
    times, values = one.times[inside], one.series[name][inside]
    unit = one.units[name]
    there = np.interp(times, other.times, unit_scale(other.units[name], unit) * other.series[name])
    apart = np.abs(there - values)
    worst = int(np.argmax(apart))
    size = float(np.max(np.abs(values)))
    largest = float(apart[worst])
    return Difference(
        name,
        unit,
        largest,
        float(times[worst]),
        float(np.sqrt(np.mean(apart**2))),
        largest / size if size > 0.0 else (0.0 if largest == 0.0 else nan),
    )


def _text_difference(
    one: Recorded, other: Recorded, name: str, begin: float, end: float
) -> TextDifference:
    changed = (time for run in (one, other) for time, _ in run.texts[name] if begin < time < end)
    times = np.array(sorted({begin, end, *changed}))
    ours, theirs = (texts_at(run.texts[name], times) for run in (one, other))
    unlike = np.asarray(ours != theirs)
    if not unlike.any():
        return TextDifference(name, 0.0, nan, "", "")
    first = int(np.argmax(unlike))
    apart = float(np.sum(np.diff(times, append=end)[unlike]))
    return TextDifference(name, apart, float(times[first]), str(ours[first]), str(theirs[first]))


def unit_scale(own: str, wanted: str) -> float:
    """Factor between two units; 1 where they are not known, NaN where they do not fit."""
    if own == wanted or not (own and wanted):
        return 1.0
    try:
        return factor(own, wanted)
    except UnitError:
        return nan
