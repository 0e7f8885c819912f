"""Two sweeps side by side."""

from __future__ import annotations

from math import isnan, nan

import numpy as np
import pytest

from orchestrator.errors import InputError
from orchestrator.studies.sweep.comparison import compared, difference
from tests.orchestrator.studies.sweep.flat import FREQUENCY, MASS, WAVEFORM, flat


def test_the_largest_difference_is_named_with_its_point() -> None:
    axes = {FREQUENCY: [48.0, 50.0, 52.0], MASS: [1e-3, 2e-3]}
    one = flat(axes, lambda f, m: 1e-3 * f)
    other = flat(axes, lambda f, m: 1e-3 * f + (3e-3 if (f, m) == (50.0, 2e-3) else -1e-3))
    found = compared(one, other)
    (travel,) = found.differences
    assert travel.largest == pytest.approx(3e-3)
    assert travel.at == {FREQUENCY: 50.0, MASS: 2e-3}
    assert travel.rms == pytest.approx(np.sqrt((9e-6 + 5e-6) / 6))
    assert travel.relative == pytest.approx(3.0 / 52.0)
    assert (travel.points, found.points, found.alone) == (6, 6, {})
    assert (travel.unit, travel.shown_in) == ("m", ("mm", 1000.0))
    apart = difference(one, other)["travel"].sel({FREQUENCY: 50.0})
    np.testing.assert_allclose(apart, [-1e-3, 3e-3])


def test_only_the_points_that_both_have_count_and_the_rest_is_named() -> None:
    one = flat({FREQUENCY: [48.0, 50.0, 52.0, 53.0]}, lambda f: f)
    other = flat({FREQUENCY: [50.0, 51.0, 52.0]}, lambda f: f + (100.0 if f == 51.0 else 0.5))
    found = compared(one, other)
    assert found.axes == {FREQUENCY: [50.0, 52.0]}
    assert found.alone == {FREQUENCY: ([48.0, 53.0], [51.0])}
    assert found.differences[0].largest == 0.5


def test_units_and_rounding_of_places_are_seen_through() -> None:
    """The order of the axes and of the places does not matter either."""
    one = flat({MASS: [0.6e-3, 0.7e-3], FREQUENCY: [1.0, 2.0, 3.0]}, lambda m, f: m + f)
    other = flat(
        {FREQUENCY: [3.0, 2.0, 1.0], MASS: [0.6 + 1e-13, 0.7]},
        lambda f, m: 1e3 * (1e-3 * m + f),
        unit="mm",
        units={MASS: "g", FREQUENCY: "Hz"},
    )
    found = compared(one, other)
    assert (found.points, found.alone) == (6, {})
    assert found.differences[0].largest < 1e-12


def test_texts_meet_by_their_letters() -> None:
    one = flat({WAVEFORM: ["sine", "square"]}, lambda w: float(len(w)))
    other = flat({WAVEFORM: ["square", "saw", "sine"]}, lambda w: len(w) + (w == "square"))
    found = compared(one, other)
    assert found.axes == {WAVEFORM: ["sine", "square"]}
    assert found.alone == {WAVEFORM: ([], ["saw"])}
    assert found.differences[0].at == {WAVEFORM: "square"}


def test_an_axis_of_one_value_is_a_setting() -> None:
    one = flat({FREQUENCY: [48.0, 50.0], MASS: [1e-3]}, lambda f, m: f)
    other = flat({FREQUENCY: [48.0, 50.0], MASS: [2e-3]}, lambda f, m: f + 1.0)
    found = compared(one, other)
    assert (list(found.axes), found.alone) == ([FREQUENCY], {MASS: ([1e-3], [2e-3])})
    assert found.units[MASS] == "kg"
    bare = compared(flat({FREQUENCY: [48.0, 50.0]}, lambda f: f), other)
    assert (bare.differences[0].largest, bare.alone) == (1.0, {MASS: ([], [2e-3])})


def test_points_without_a_value_do_not_count() -> None:
    one = flat({FREQUENCY: [48.0, 50.0, 52.0]}, lambda f: nan if f == 48.0 else f, none=nan)
    other = flat({FREQUENCY: [48.0, 50.0, 52.0]}, lambda f: nan if f == 52.0 else f + 0.5, none=1.0)
    travel, none = compared(one, other).differences
    assert (travel.points, travel.largest, travel.rms) == (1, 0.5, 0.5)
    assert (none.points, none.at, isnan(none.largest)) == (0, {}, True)


def test_metrics_of_one_are_listed_and_chosen_by_pattern() -> None:
    one = flat({FREQUENCY: [48.0, 50.0]}, lambda f: f, here=1.0, both=1.0)
    other = flat({FREQUENCY: [48.0, 50.0]}, lambda f: f, there=1.0, both=2.0)
    found = compared(one, other)
    assert [each.name for each in found.differences] == ["both", "travel"]
    assert found.missing == (["there"], ["here"])
    assert [each.name for each in compared(one, other, patterns=["tr*"]).differences] == ["travel"]
    with pytest.raises(InputError, match="did you mean 'travel'"):
        compared(one, other, patterns=["travle"])


@pytest.mark.parametrize(
    ("axes", "reason"),
    [
        ({FREQUENCY: [49.0, 51.0]}, f"no point in common: no value of {FREQUENCY} is in both"),
        ({MASS: [1.0, 2.0]}, f"has the axes {FREQUENCY}; another has {MASS}.*select with xarray"),
        ({FREQUENCY: [48.0, 50.0], MASS: [1.0, 2.0]}, f"another has {FREQUENCY}, {MASS}"),
    ],
)
def test_what_does_not_go_together_is_refused(axes: dict[str, list[float]], reason: str) -> None:
    one = flat({FREQUENCY: [48.0, 50.0]}, lambda f: f)
    with pytest.raises(InputError, match=reason):
        compared(one, flat(axes, lambda *place: 1.0))
