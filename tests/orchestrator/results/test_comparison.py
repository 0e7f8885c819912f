"""Two runs side by side."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest

from orchestrator.errors import InputError
from orchestrator.results.comparison import compared, differing
from orchestrator.results.recorded import Recorded
from orchestrator.results.texts import Change

METRICS = {"cycles": 5, "top": "max(tank.level) in mm", "still": "mean(tank.zero)"}


def run(rows: int, *, shift: float = 0.0, unit: str = "m", begin: float = 0.0) -> Recorded:
    """A level that rises by 1 m/s, moved by `shift` [m], over one second; and two constants."""
    times = np.linspace(begin, begin + 1.0, rows)
    scale = {"m": 1.0, "mm": 1000.0}[unit]
    return Recorded(
        times,
        {
            "tank.level": scale * (times + shift),
            "tank.zero": np.zeros(rows),
            "tank.one": np.ones(rows),
        },
        {"tank.level": unit, "tank.zero": "1", "tank.one": ""},
        metrics=METRICS,
    )


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_differences_are_taken_at_the_first_one_s_times(unit: str) -> None:
    """Whatever the steps and the units of the second one are."""
    found = compared(run(11), run(8, shift=0.25, unit=unit))
    level, *rest = found.differences
    assert (level.name, level.unit) == ("tank.level", "m")
    assert (level.largest, level.rms, level.relative) == pytest.approx((0.25, 0.25, 0.25))
    assert [each.largest for each in rest] == [0.0, 0.0]
    assert [each.relative for each in rest] == [0.0, 0.0]
    assert (found.begin, found.end) == (0.0, 1.0)


def test_only_the_time_that_both_have_counts() -> None:
    found = compared(run(11), run(11, begin=0.5, shift=0.1))
    assert (found.begin, found.end) == (0.5, 1.0)
    assert found.differences[0].largest == pytest.approx(0.1)
    with pytest.raises(InputError, match=r"no time in common: one is from 0 to 1 s, the other"):
        compared(run(11), run(11, begin=2.0))


def test_metrics_stand_beside_each_other() -> None:
    top, still = compared(run(11), run(11, shift=0.5)).metrics
    assert top.one is not None and top.other is not None
    assert (top.name, top.one.shown, top.other.shown) == ("top", "1000 mm", "1500 mm")
    assert top.change == pytest.approx(0.5)
    assert still.change == 0.0


def test_what_only_one_has_is_listed() -> None:
    one, other = run(11), run(11)
    less = Recorded(
        one.times,
        {"tank.level": one.series["tank.level"], "tank.more": one.series["tank.one"]},
        {"tank.level": "m", "tank.more": "m"},
        metrics={"more": "max(tank.more)"},
    )
    found = compared(less, other)
    assert [each.name for each in found.differences] == ["tank.level"]
    assert found.missing == (["tank.zero", "tank.one"], ["tank.more"])
    assert all(isnan(pair.change) for pair in found.metrics)


def test_settings_that_mean_the_same_are_alike() -> None:
    one = {"a.x": "0.1 ms", "a.y": "18 Hz", "a.z": "square", "a.only": "1"}
    other = {"a.x": "0.0001 s", "a.y": "16 Hz", "a.z": "sine"}
    assert differing(one, other) == {
        "a.y": ("18 Hz", "16 Hz"), "a.z": ("square", "sine"), "a.only": ("1", None),
    }  # fmt: skip
    assert differing(one, {}) == {}


def saying(*changes: Change, name: str = "mode.text") -> Recorded:
    still = run(11)
    return Recorded(still.times, still.series, still.units, texts={name: changes})


@pytest.mark.parametrize(
    ("ours", "theirs", "found"),
    [
        ([(0.0, "on")], [(0.0, "on")], (0.0, None, "", "")),
        ([(0.0, "on"), (0.4, "off")], [(0.0, "on"), (0.7, "off")], (0.3, 0.4, "off", "on")),
        ([(0.0, "a")], [(0.0, "b"), (0.25, "a"), (0.75, "c")], (0.5, 0.0, "a", "b")),
        ([(0.0, "on")], [(0.0, "on"), (1.0, "off")], (0.0, 1.0, "on", "off")),
        ([(0.0, "on")], [(0.5, "on")], (0.5, 0.0, "on", "")),
    ],
    ids=["alike", "later", "twice", "at the end", "not yet"],
)
def test_texts_differ_for_a_time(
    ours: list[Change], theirs: list[Change], found: tuple[float, float | None, str, str]
) -> None:
    (text,) = compared(saying(*ours), saying(*theirs)).texts
    first = None if isnan(text.first) else text.first
    assert (text.apart, first, text.ours, text.theirs) == pytest.approx(found)


def test_texts_are_chosen_and_missed_like_numbers() -> None:
    one, other = saying((0.0, "on")), saying((0.0, "on"), name="mode.word")
    assert compared(one, other).missing == (["mode.word"], ["mode.text"])
    found = compared(one, saying((0.0, "off")), patterns=["mode.*"])
    assert ([each.name for each in found.texts], found.differences) == (["mode.text"], [])
    assert compared(one, one, patterns=["tank.*"]).texts == []


def test_variables_are_chosen_by_pattern() -> None:
    assert [d.name for d in compared(run(5), run(5), patterns=["*.zero"]).differences] == [
        "tank.zero"
    ]
    with pytest.raises(InputError, match=r"'tank.levle': not in both .*did you mean 'tank.level'"):
        compared(run(5), run(5), patterns=["tank.levle"])
