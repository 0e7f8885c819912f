"""Interpolation: values, slopes, means, what lies outside, and repetition."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from orchestrator.recording.interpolation import Track, Unfit, fitted

KINDS = ("held", "linear", "cubic", "band-limited")
TIMES = np.linspace(0.0, 1.0, 41)


def wave(t: float | np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(2.0 * np.pi * 2.0 * np.asarray(t)))


def waves(kind: str, **options: object) -> Track:
    return fitted(TIMES, wave(TIMES)[:, None], kind, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("period", [0.0, 1.0])
def test_samples_are_met(kind: str, period: float) -> None:
    track = waves(kind, period=period)
    got = [track.at(t)[0][0] for t in TIMES]
    np.testing.assert_allclose(got, wave(TIMES), atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "value", "slope"),
    [
        ("held", 0.32, 13.0),
        ("linear", 0.013, 2.0),
        ("cubic", 0.01, 1.5),
        ("band-limited", 2e-4, 0.02),
    ],
)
def test_between_samples(kind: str, value: float, slope: float) -> None:
    track = waves(kind)
    inner = np.linspace(0.1, 0.9, 333)
    values = np.array([track.at(t)[0][0] for t in inner])
    slopes = np.array([track.at(t)[1][0] for t in inner])
    assert np.abs(values - wave(inner)).max() < value
    exact = 4.0 * np.pi * np.cos(4.0 * np.pi * inner)
    assert np.abs(slopes - exact).max() < slope


def test_cubic_does_not_overshoot_a_step() -> None:
    track = fitted(np.arange(6.0), np.array([0.0, 0, 0, 1, 1, 1])[:, None], "cubic")
    values = [track.at(t)[0][0] for t in np.linspace(0.0, 5.0, 101)]
    assert min(values) >= 0.0
    assert max(values) <= 1.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"before": "zero", "after": "zero"},
        {"before": "hold", "after": "hold"},
        {"period": 1.0},
        {"period": 1.05},
    ],
)
def test_means_are_those_of_the_interpolant(kind: str, options: dict[str, object]) -> None:
    """By quadrature between the knots; steps that begin and end anywhere, the seam included."""
    if kind == "band-limited" and options.get("period") == 1.05:
        return
    track = waves(kind, **options)
    for begin, end in ((0.1, 0.11), (0.333, 0.9), (-0.4, 0.2), (0.7, 1.6), (1.1, 3.2)):
        marks = [t + n * track.period for t in [*track.knots, track.end] for n in range(-2, 5)]
        edges = sorted({begin, end, *[t for t in marks if begin < t < end]})
        for power, mean in zip((1, 2), track.means(end, end - begin), strict=True):
            total = sum(
                quad(lambda t, p=power: track.at(t)[0][0] ** p, a + 1e-9, b - 1e-9)[0]
                for a, b in pairwise(edges)
                if b - a > 1e-7
            )
            assert mean[0] == pytest.approx(total / (end - begin), abs=2e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_cycle_continues_in_both_directions(kind: str) -> None:
    track = waves(kind, period=1.0)
    for t in (0.013, 0.5, 0.9876, 0.0):
        for turns in (-3, 1, 1000):
            value, slope = track.at(t + turns)
            assert value[0] == pytest.approx(track.at(t)[0][0], abs=1e-9)
            assert slope[0] == pytest.approx(track.at(t)[1][0], abs=1e-7)


def test_a_cycle_without_its_last_sample_is_closed_by_its_first() -> None:
    track = fitted(TIMES[:-1], wave(TIMES[:-1])[:, None], "band-limited", period=1.0)
    assert track.end == 1.0
    assert track.at(0.99)[0][0] == pytest.approx(wave(0.99), abs=2e-4)


def test_a_step_looks_back_and_a_start_looks_ahead() -> None:
    track = fitted(np.array([0.0, 1.0, 2.0]), np.array([[0.0], [1.0], [-1.0]]), "linear")
    assert track.at(1.0)[1][0] == -2.0
    assert track.at(1.0, stepped=True)[1][0] == 1.0
    assert track.at(2.0, stepped=True)[1][0] == -2.0
    wrapped = fitted(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]), "linear", period=2.0)
    assert wrapped.at(2.0, stepped=True)[1][0] == -1.0
    assert wrapped.at(2.0)[1][0] == 1.0


def test_outside_the_record() -> None:
    held = waves("linear")
    gone = fitted(TIMES, 1.0 + wave(TIMES)[:, None], "linear", before="zero", after="zero")
    assert held.at(-1.0)[0][0] == wave(0.0)
    assert held.at(3.0)[0][0] == pytest.approx(wave(1.0))
    assert gone.at(-1.0)[0][0] == gone.at(1.1)[0][0] == 0.0
    assert gone.at(0.0)[0][0] == 1.0


def test_band_limited_needs_even_samples() -> None:
    times = np.array([0.0, 1.0, 2.5, 3.0])
    with pytest.raises(Unfit, match=r"apart at t = 0 s|apart at t = 1 s"):
        fitted(times, times[:, None], "band-limited")


@pytest.mark.parametrize("kind", KINDS)
def test_two_rows_are_enough(kind: str) -> None:
    track = fitted(np.array([0.0, 1.0]), np.array([[1.0], [2.0]]), kind)
    assert 1.0 <= track.at(0.5)[0][0] <= 2.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("period", [0.0, 6.0])
@pytest.mark.parametrize(
    ("time", "value", "column", "words"),
    [
        (2.0, 1e308, 1, "1e\\+308 is beyond"),
        (2.0, -1e101, 1, "is beyond"),
        (2.0, float("inf"), 1, "inf is beyond"),
        (1.0 + 3e-16, 0.0, None, "times .* apart"),
    ],
)
def test_what_no_polynomial_holds_is_refused_with_its_place(
    kind: str, period: float, time: float, value: float, column: int | None, words: str
) -> None:
    times, values = np.array([0.0, 1.0, time, 5.0]), np.zeros((4, 3))
    values[2, 1] = value
    with pytest.raises(Unfit, match=words) as caught:
        fitted(times, values, kind, period=period)
    assert (caught.value.row, caught.value.column) == (2, column)


@pytest.mark.parametrize("kind", ["held", "linear", "cubic"])
@pytest.mark.parametrize("size", [1e-59, 1.0, 1e99])
@pytest.mark.parametrize("period", [False, True])
def test_extreme_samples_have_finite_interpolants(kind: str, size: float, period: bool) -> None:
    times = size * np.arange(5.0)
    values = 1e100 * np.array([0.0, 1.0, -1.0, 1.0, 0.0])[:, None]
    track = fitted(times, values, kind, period=times[-1] if period else 0.0)
    for part in (track.pieces, track.first, track.second):
        assert np.isfinite(part).all()
