"""The peak of a metric over an axis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import InputError
from orchestrator.studies.sweep.peak import (
    FINEST,
    Peak,
    middles,
    peak_of,
    spacing,
    uncertainty_of,
)
from tests.orchestrator.studies.sweeps import STROKE, Sweep, files


@pytest.mark.parametrize("top", [3.3, 5.0, 7.9])
def test_bisection_finds_a_resonance(top: float) -> None:
    """From a grid of nine to the peak of |1 / (1 - r^2 + 2 i zeta r)|, in few points."""

    def response(place: float) -> float:
        r = place / top
        return float(1.0 / abs(1 - r**2 + 0.2j * r))

    values = {float(place): response(place) for place in range(1, 10)}
    finest = FINEST * spacing(values)
    while more := middles(values, finest):
        values |= {place: response(place) for place in more}
    found = peak_of(values)
    assert found is not None
    exact = top * math.sqrt(1 - 2 * 0.1**2)
    assert abs(found.at - exact) < finest
    assert found.value == pytest.approx(response(exact), rel=1e-3)
    error = uncertainty_of(values)
    assert error is not None
    assert abs(found.at - exact) < 2.0 * error.at < 2.0 * finest
    assert abs(found.value - response(exact)) < 2.0 * error.value
    assert len(values) <= 9 + 6


@pytest.mark.parametrize(
    ("values", "peak"),
    [
        ({}, None),
        ({1.0: math.nan}, None),
        ({1.0: 2.0}, Peak(1.0, 2.0)),
        ({1.0: 2.0, 2.0: 3.0}, Peak(2.0, 3.0)),
        ({0.0: 0.0, 1.0: 1.0, 2.0: 0.0}, Peak(1.0, 1.0)),
        ({0.0: 0.0, 1.0: 3.0, 2.0: 4.0, 3.0: 3.0}, Peak(2.0, 4.0)),
        ({0.0: 1.0, 1.0: 4.0, 3.0: 4.0}, Peak(2.0, 5.0)),
        ({0.0: 0.0, 1.0: 1.0, 2.0: math.nan}, Peak(1.0, 1.0)),
        ({0.0: 1.0, 1.0: 1.0, 2.0: 1.0}, Peak(0.0, 1.0)),
    ],
)
def test_the_top_of_a_parabola(values: Mapping[float, float], peak: Peak | None) -> None:
    found = peak_of(values)
    if peak is None or found is None:
        assert found is peak
    else:
        assert (found.at, found.value) == pytest.approx((peak.at, peak.value))


@pytest.mark.parametrize(
    "values",
    [
        {},
        {0.0: 1.0, 1.0: 2.0, 2.0: 3.0, 3.0: 4.0},
        {0.0: 1.0, 1.0: 2.0, 2.0: 1.0},
        {0.0: 1.0, 1.0: 2.0, 2.0: math.nan, 3.0: 0.0},
    ],
    ids=["nothing", "at an end", "three points", "beside no value"],
)
def test_a_peak_that_is_not_enclosed_has_no_uncertainty(values: Mapping[float, float]) -> None:
    assert uncertainty_of(values) is None


def test_whole_numbers_are_bisected_into_whole_numbers() -> None:
    values = {2.0: 1.0, 4.0: 3.0, 5.0: 2.0}
    assert middles(values, 0.1, whole=True) == [3.0]


def test_refining_adds_points_at_the_peak(swept: Sweep, tmp_path: Path) -> None:
    """They are in order and kept as others are, and the result has the place of the peak."""
    target = tmp_path / "out.nc"
    coarse = "amplifier.frequency=8:26/4Hz"
    data = swept(coarse, target=target, refine=STROKE, keep=True)
    places, stroke = data["amplifier.frequency"].values, data[STROKE].values
    assert 4 < len(places) <= 10
    assert (np.diff(places) > 0).all()
    fine = swept("amplifier.frequency=15:23/17Hz", target=tmp_path / "fine.nc")
    best = int(np.argmax(fine[STROKE].values))
    assert abs(data.attrs["peak_at"] - fine["amplifier.frequency"].values[best]) <= 0.75
    assert data.attrs["peak"] == pytest.approx(float(fine[STROKE].values[best]), rel=5e-3)
    assert stroke.max() <= data.attrs["peak"] * (1 + 1e-12)
    assert 0.0 < data.attrs["peak_at_uncertainty"] < 4.0
    assert list(places[data["added"].values == 0]) == [8.0, 14.0, 20.0, 26.0]
    before = files(target)
    again = swept(coarse, target=target, refine=STROKE, keep=True)
    assert files(target) == before
    xarray.testing.assert_identical(again, data)


def test_what_cannot_be_refined_is_refused(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    frequencies = "amplifier.frequency=17,18,19Hz"
    for axes, reason in [
        ([frequencies, "linkage.damping=0.1,0.2"], "over one axis"),
        (["amplifier.waveform=square,sine,half_wave_sine"], "takes texts"),
        (["amplifier.frequency=17,18Hz"], "fewer than three"),
    ]:
        with pytest.raises(InputError, match=reason):
            swept(*axes, target=target, refine=STROKE)
    with pytest.raises(InputError, match=r"no metric 'flaping stroke'; did you mean 'flapping str"):
        swept(frequencies, target=target, refine="flaping stroke")
    assert list(tmp_path.iterdir()) == []
