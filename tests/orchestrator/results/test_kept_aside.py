"""A result is not overwritten by one of another setting."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray

from orchestrator.errors import KeptWarning
from orchestrator.results.kept_aside import digest, keep_other

ONE = {"scenario": '{"title": "one"}', "fmu_sha256": "{}", "complete": 1}
OTHERS = [
    ONE | {"scenario": '{"title": "other"}'},
    ONE | {"fmu_sha256": '{"spring": "00"}'},
    ONE | {"points": "00"},
]


@pytest.fixture
def result(tmp_path: Path) -> Path:
    path = tmp_path / "a.nc"
    xarray.Dataset(attrs=ONE).to_netcdf(path)
    path.with_suffix(".png").write_text("its plot")
    return path


@pytest.mark.parametrize("other", OTHERS)
def test_a_result_of_another_setting_is_kept_under_its_digest(
    other: dict[str, str], result: Path
) -> None:
    with pytest.warns(KeptWarning, match=r"a\.nc held a result of another setting or FMU"):
        kept = keep_other(result, other)
    assert kept == result.with_name(f"a.{digest(ONE)}.nc")
    assert sorted(p.name for p in result.parent.iterdir()) == [kept.name, f"a.{digest(ONE)}.png"]
    with xarray.open_dataset(kept) as read:
        assert read.attrs["scenario"] == ONE["scenario"]


def test_one_of_the_same_setting_may_be_replaced(result: Path) -> None:
    assert keep_other(result, ONE | {"complete": 0, "wall_time": 3.0}) is None
    assert result.exists()


def test_a_result_of_the_previous_release_is_known_by_its_scene(result: Path) -> None:
    xarray.Dataset(attrs={"scene": ONE["scenario"], "fmu_sha256": "{}"}).to_netcdf(result)
    assert keep_other(result, ONE) is None


@pytest.mark.parametrize("content", [None, b"", b"no netCDF"])
def test_what_is_no_result_is_left_alone(content: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "a.nc"
    if content is not None:
        path.write_bytes(content)
    assert keep_other(path, ONE) is None
    assert path.exists() == (content is not None)
