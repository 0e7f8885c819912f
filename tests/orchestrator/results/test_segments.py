"""Long runs on disk: closed pieces, a killed run, one whole file at the end."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import InputError, OutputError
from orchestrator.results.netcdf import folder_of, partial_path, recover, segments_for, write
from orchestrator.results.segments import found
from orchestrator.simulation.load import load
from orchestrator.simulation.observers import Recorder
from orchestrator.simulation.run import run
from tests.processes import python, started, until

SPAN = {"stop": "30 cycles"}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Recorder, "SEGMENT", 1)


def test_segments_become_one_file(library: Path, tmp_path: Path, small: None) -> None:
    """The same rows as a run that stays in memory, and no folder left."""
    plan = load("oscillator-1", None, library, time=SPAN)
    whole = run(plan)
    target = tmp_path / "long.nc"
    done = run(plan, segments=segments_for(plan, target))
    assert done.segments is not None
    assert len(done.segments.digests) == len(whole.times) // 256
    assert folder_of(target).is_dir()
    assert write(done, target) == target
    assert sorted(p.name for p in tmp_path.iterdir()) == ["long.nc"]
    with xarray.open_dataset(target) as data:
        assert np.array_equal(data["time"].values, whole.times)
        for name in whole.names:
            assert np.array_equal(data[name].values, whole.series(name))
        assert data["payload.displacement"].attrs["units"] == "m"
        assert data.attrs["complete"] == 1


def test_an_estimate_reaches_into_segments(library: Path, tmp_path: Path, small: None) -> None:
    plan = load("oscillator-1", None, library, time=SPAN)
    plain = run(plan, estimate=True)
    done = run(plan, segments=segments_for(plan, tmp_path / "long.nc"), estimate=True)
    assert done.segments
    assert done.estimates == plain.estimates


def test_a_damaged_segment_is_refused(library: Path, tmp_path: Path, small: None) -> None:
    plan = load("oscillator-1", None, library, time=SPAN)
    target = tmp_path / "long.nc"
    done = run(plan, segments=segments_for(plan, target))
    piece = folder_of(target) / "000001.nc"
    content = bytearray(piece.read_bytes())
    content[len(content) // 2] ^= 1
    piece.write_bytes(content)
    with pytest.raises(InputError, match=r"000001\.nc: is not what was written"):
        write(done, target)
    assert not target.exists()
    assert [p.name for p in tmp_path.iterdir()] == ["long.segments"]


def test_segments_of_another_run_are_not_touched(
    library: Path, tmp_path: Path, small: None
) -> None:
    plan = load("oscillator-1", None, library, time=SPAN)
    target = tmp_path / "long.nc"
    folder_of(target).mkdir()
    done = run(plan, segments=segments_for(plan, target))
    assert isinstance(done.failure, OutputError)
    assert "resilin recover" in str(done.failure)


def test_a_killed_run_can_be_recovered(library: Path, tmp_path: Path) -> None:
    """kill -9 in mid-run: the closed segments are there, and the file is marked as incomplete."""
    target = tmp_path / "long.nc"
    code = f"""
from orchestrator.simulation.observers import Recorder
from orchestrator.results.netcdf import segments_for
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from pathlib import Path
Recorder.SEGMENT = 1
plan = load("oscillator-1", None, Path({str(library)!r}), time={{"stop": "100000 cycles"}})
run(plan, segments=segments_for(plan, Path({str(target)!r})))
"""
    folder = folder_of(target)
    with started(python("-c", code)) as process:
        until(lambda: len(list(folder.glob("*.nc"))) >= 5, process)
    closed = len(found(folder).digests)
    assert closed >= 4
    path, rows = recover(folder)
    assert path == partial_path(target)
    assert rows == 256 * closed
    assert not folder.exists()
    with xarray.open_dataset(path) as data:
        assert data.attrs["complete"] == 0
        assert data.sizes["time"] == rows
        assert np.all(np.diff(data["time"].values) > 0.0)


def test_nothing_to_recover_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no segments of a run here"):
        recover(tmp_path / "none.segments")


def test_last_stretch_and_decimation(library: Path) -> None:
    """The last two of four cycles, every third row; the steps do not change."""
    record = {"last": "2 cycles", "every": 3}
    whole = run(load("oscillator-1", None, library, time={"stop": "4 cycles"}))
    plan = load("oscillator-1", None, library, time={"stop": "4 cycles"}, record=record)
    done = run(plan)
    assert done.steps == whole.steps
    kept = np.flatnonzero(np.isin(whole.times, done.times))
    assert np.array_equal(kept % 3, np.zeros(len(kept)))
    assert done.times[0] >= 2.0 / (plan.frequency or 1.0) - 1e-9
    assert np.array_equal(done.rows, whole.rows[kept])
