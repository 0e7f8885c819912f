"""A sweep as a dataset: its axes are dimensions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.results.metrics import metrics
from orchestrator.studies.sweep.dataset import collected, over_axes, write
from orchestrator.studies.sweep.metric_units import shown_units
from orchestrator.studies.sweep.points import Point, Record, point_at
from tests.conftest import Runner
from tests.orchestrator.studies.sweep.grids import Metrics, grid, made

FREQUENCY, MASS, WAVEFORM = "amplifier.frequency", "payload.mass", "amplifier.waveform"


def travel(point: Point) -> Metrics:
    """Frequency in Hz plus mass in kg, as metres."""
    return (("travel", sum(place for place in point.place if isinstance(place, float)), "m"),)


def test_axes_are_dimensions_with_rising_numbers(library: Path, tmp_path: Path) -> None:
    swept = grid(library, f"{FREQUENCY}=54,48,50Hz", f"{MASS}=2,1g", f"{WAVEFORM}=square,sine")
    data = made(swept, travel)
    write(data, tmp_path / "sweep.nc")
    with xarray.open_dataset(tmp_path / "sweep.nc") as read:
        xarray.testing.assert_identical(read.load(), data)
    assert data["travel"].dims == (FREQUENCY, MASS, WAVEFORM)
    assert list(data[FREQUENCY].values) == [48.0, 50.0, 54.0]
    assert list(data[MASS].values) == [1e-3, 2e-3]
    assert list(data[WAVEFORM].values) == ["square", "sine"]
    near = data["travel"].sel({FREQUENCY: 52.5, MASS: 0.0019}, method="nearest")
    np.testing.assert_array_equal(near.values, [54.002, 54.002])
    assert data["travel"].attrs == {"units": "m", "long_name": "travel", "shown_in": "mm"}
    assert data[MASS].attrs["units"] == "kg"


def test_points_between_those_of_the_grid_are_marked(library: Path) -> None:
    swept = grid(library, f"{FREQUENCY}=48,50,54Hz")
    more = point_at(swept.setting, (FREQUENCY,), ("52 Hz",))[1]
    points = [*swept.points, more]
    data = collected(swept, points, {p.key: Record("done", "", travel(p)) for p in points})
    assert data["travel"].sizes == {FREQUENCY: 4}
    assert list(data[FREQUENCY].values) == [48.0, 50.0, 52.0, 54.0]
    assert list(data["added"].values) == [0, 0, 1, 0]


def test_a_metric_of_any_name_is_kept(library: Path) -> None:
    """Also that of an axis, or of what a sweep knows beside metrics."""
    names = ("status", "steps", FREQUENCY)
    data = made(
        grid(library, f"{FREQUENCY}=48,50Hz"), lambda point: tuple((n, 2.0, "1") for n in names)
    )
    assert set(data["status"].values) == {"done"}
    for name in names:
        assert list(data[f"metric {name}"].values) == [2.0, 2.0]
        assert data[f"metric {name}"].attrs["long_name"] == name


@pytest.mark.parametrize(
    "axes", [(f"{FREQUENCY}=48,50Hz",), (f"{FREQUENCY}=48,50Hz", f"{MASS}=1,2g")]
)
def test_a_sweep_of_an_earlier_release_is_laid_over_its_axes(
    axes: tuple[str, ...], library: Path
) -> None:
    """There all points were along one dimension."""
    data = made(grid(library, *axes), travel)
    names = [str(name) for name in data.dims]
    places = np.meshgrid(*(data[name].values for name in names), indexing="ij")
    old = xarray.Dataset(
        {name: ("point", each.values.ravel(), each.attrs) for name, each in data.items()},
        {
            name: ("point", place.ravel(), data[name].attrs)
            for name, place in zip(names, places, strict=True)
        },
        data.attrs,
    )
    xarray.testing.assert_identical(over_axes(old), data)
    assert over_axes(data) is data


@pytest.mark.parametrize(
    "options",
    [{}, {"record": {"variables": ["spring.*"]}, "metrics": {"pull": "max(spring.force.value)"}}],
)
def test_names_and_units_of_metrics_are_known_before_a_run(
    options: dict[str, object], outcome: Runner
) -> None:
    done = outcome("oscillator-1", time={"stop": "4 cycles"}, **options)
    units = shown_units(done.plan)
    assert [(m.name, m.shown.partition(" ")[2]) for m in metrics(done)] == [
        (name, "" if unit == "1" else unit) for name, unit in units.items()
    ]
