"""Axes of a sweep: read, checked, refused with the way out."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import InputError, ScenarioError
from orchestrator.studies.sweep.axes import MOST_POINTS, check_axes
from orchestrator.studies.sweep.study import Axis, parse_axis
from tests.orchestrator.studies.sweeps import Sweep


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("amplifier.frequency=1:10:4Hz", ("1 Hz", "5 Hz", "9 Hz")),
        ("amplifier.frequency=1:9:4 Hz", ("1 Hz", "5 Hz", "9 Hz")),
        ("amplifier.frequency = 1Hz:9Hz:4Hz", ("1 Hz", "5 Hz", "9 Hz")),
        ("amplifier.frequency=1:50/3Hz", ("1 Hz", "25.5 Hz", "50 Hz")),
        ("amplifier.frequency=-1 Hz : 1 Hz / 3 Hz", ("-1 Hz", "0 Hz", "1 Hz")),
        ("a.b=0:0.4:0.1", ("0", "0.1", "0.2", "0.3", "0.4")),
        ("a.b=1e-3:3e-3:1e-3 m/s", ("0.001 m/s", "0.002 m/s", "0.003 m/s")),
        ("a.b=5:5:1", ("5",)),
        ("spring.layers=2,4,6,8", ("2", "4", "6", "8")),
        ("spring.length=20,25,30 mm", ("20 mm", "25 mm", "30 mm")),
        ("spring.length=20mm", ("20 mm",)),
        ("amplifier.waveform=square, sine", ("square", "sine")),
        ("a.b.c=2D,3D,flat", ("2D", "3D", "flat")),
    ],
)
def test_an_axis_is_read(text: str, values: tuple[str, ...]) -> None:
    axis = parse_axis(text)
    assert axis.values == values
    assert axis.name == text.partition("=")[0].strip()


def test_figure_11_has_its_26_points() -> None:
    values = parse_axis("amplifier.frequency=1:50/26Hz").values
    assert len(values) == 26
    assert values[:2] == ("1 Hz", "2.96 Hz")
    assert values[-1] == "50 Hz"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "component.parameter=values"),
        ("amplifier=1:2:1", "component.parameter=values"),
        ("=1:2:1", "component.parameter=values"),
        ("a.b", "component.parameter=values"),
        ("a.b=", "empty value"),
        ("a.b=1,,2", "empty value"),
        ("a.b=1:2", "is not a range"),
        ("a.b=1:2:3:4", "is not a range"),
        ("a.b=1:x:2", "is not a range"),
        ("a.b=1:50/2.5Hz", "is not a range"),
        ("a.b=1:50:26#Hz", "is not a range"),
        ("a.b=1:2:0Hz", "above zero"),
        ("a.b=1:2:-1Hz", "above zero"),
        ("a.b=2:1:1", "backwards"),
        ("a.b=2:1/3", "backwards"),
        ("a.b=1:1/3", "room for one point"),
        ("a.b=1:2/1", "at least 2"),
        ("a.b=1:2/0", "at least 2"),
        ("a.b=0:1:1e-9", "more than 100000"),
        ("a.b=0:1/100001", "more than 100000"),
        ("a.b=0:1/" + "9" * 5000, "more than 100000"),
        ("a.b=0:1e999:1", "not a finite number"),
        ("a.b=0:1e300:1e-300", "more than 100000"),
        ("a.b=1Hz:1kHz:1Hz", "mixes units"),
        ("a.b=1Hz:2:3", "mixes units"),
        ("a.b=1:2Hz:3Hz", "some numbers only"),
        ("a.b=1mm,2m", "mixes units"),
        ("a.b=1mm,2", "mixes units"),
        ("a.b=1,square", "mixes numbers and texts"),
        ("a.b=1,2,1.0", "twice"),
        ("a.b=sine,sine", "twice"),
    ],
)
def test_a_bad_axis_is_refused_with_the_way_out(text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        parse_axis(text)


def test_axes_that_make_no_sweep_are_refused() -> None:
    many = Axis("a.b", tuple(str(k) for k in range(1000)))
    for axes, changes, reason in [
        ([], {}, "at least one axis"),
        ([many, many], {}, "a.b: is given twice"),
        ([many], {"a.b": "3"}, "set to '3' as well"),
        ([many, Axis("a.c", many.values)], {}, f"1000 x 1000 = 1000000.*{MOST_POINTS}"),
    ]:
        with pytest.raises(InputError, match=reason):
            check_axes(axes, changes)


def test_all_points_are_checked_before_anything_runs(swept: Sweep, tmp_path: Path) -> None:
    """Every problem once, however many points have it; nothing is left on disk."""
    axes = ["amplifier.frequency=-2,-1,5 Hz", "actuator.layers=2,2.5", "linkage.dampin=1,2"]
    with pytest.raises(ScenarioError) as caught:
        swept(*axes[:2], target=tmp_path / "out.nc")
    assert len(caught.value.problems) == 3
    with pytest.raises(ScenarioError, match="damping"):
        swept(axes[2], target=tmp_path / "out.nc")
    assert not list(tmp_path.iterdir())
