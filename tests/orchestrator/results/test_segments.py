"""Long runs on disk: closed pieces, a killed run, one whole file at the end."""

from __future__ import annotations

import signal
from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import InputError, OutputError
from orchestrator.results import netcdf, segments
from orchestrator.results.lock import Lock
from orchestrator.results.netcdf import (
    folder_of,
    partial_path,
    prepare,
    recover,
    segments_for,
    write,
)
from orchestrator.results.segments import found
from orchestrator.simulation.interrupt import Interrupted
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
    plain = run(plan)
    target = tmp_path / "long.nc"
    done = run(plan, segments=segments_for(plan, target))
    assert done.segments is not None
    assert len(done.segments.digests) == len(plain.times) // 256
    assert folder_of(target).is_dir()
    assert write(done, target) == target
    assert sorted(p.name for p in tmp_path.iterdir()) == ["long.nc"]
    with xarray.open_dataset(target) as data:
        assert np.array_equal(data["time"].values, plain.times)
        for name in plain.names:
            assert np.array_equal(data[name].values, plain.series(name))
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
from orchestrator.simulation.interrupt import Interrupted
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
        with pytest.raises(InputError, match="still alive"):
            recover(folder)
        assert process.poll() is None
    left = found(folder)
    closed = len(left.digests)
    left.lock.release()
    assert closed >= 4
    path, rows, lost = recover(folder)
    assert (path, lost) == (partial_path(target), [])
    assert rows == 256 * closed
    assert not folder.exists()
    with xarray.open_dataset(path) as data:
        assert data.attrs["complete"] == 0
        assert data.sizes["time"] == rows
        assert np.all(np.diff(data["time"].values) > 0.0)


def test_all_but_the_damaged_segment_is_recovered(
    library: Path, tmp_path: Path, small: None
) -> None:
    """The folder stays: what is damaged may be of use to somebody."""
    plan = load("oscillator-1", None, library, time=SPAN)
    target = tmp_path / "long.nc"
    done = run(plan, segments=segments_for(plan, target))
    assert done.segments is not None
    done.segments.lock.release()
    folder, count = folder_of(target), len(done.segments.digests)
    (folder / "000001.nc").write_bytes(b"")
    path, rows, lost = recover(folder)
    assert (rows, lost) == (256 * (count - 1), ["000001.nc"])
    assert path.exists() and folder.exists()
    for piece in folder.glob("*.nc"):
        piece.write_bytes(b"")
    with pytest.raises(InputError, match="no segment is whole"):
        recover(folder)


@pytest.mark.parametrize("full", [0, 2])
def test_a_full_disk_keeps_what_is_there(
    full: int, library: Path, tmp_path: Path, small: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """netCDF4 reports it as a RuntimeError; the rows still in memory fit nowhere."""
    plan = load("oscillator-1", None, library, time=SPAN)
    target = tmp_path / "long.nc"
    target.write_bytes(b"an earlier result")
    write_piece = segments._write_piece

    def limited(path: Path, *arguments: object) -> None:
        if path.name == f".{full:06d}.nc.part":
            path.write_bytes(b"half")
            raise RuntimeError("NetCDF: HDF error")
        write_piece(path, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(segments, "_write_piece", limited)
    done = run(plan, segments=segments_for(plan, target))
    assert isinstance(done.failure, OutputError)
    assert f"{full:06d}.nc: cannot be written" in str(done.failure)
    assert done.kept == 256 * (full + 1)

    def nowhere(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(netcdf, "assemble", nowhere)
    with pytest.raises(OutputError, match="resilin recover" if full else "No space left"):
        write(done, target)
    assert target.read_bytes() == b"an earlier result"
    monkeypatch.undo()
    if full:
        assert recover(folder_of(target))[1] == 256 * full
        partial_path(target).unlink()
    assert list(tmp_path.iterdir()) == [target]


def test_left_segments_are_told_before_the_run(tmp_path: Path) -> None:
    folder_of(tmp_path / "long.nc").mkdir()
    (folder_of(tmp_path / "long.nc") / segments.MANIFEST).write_text("{}")
    with pytest.raises(OutputError, match=r"resilin recover .*long\.segments"):
        prepare(tmp_path / "long.nc")


def test_a_folder_without_a_whole_segment_is_in_nobodys_way(library: Path, tmp_path: Path) -> None:
    """A run that was killed while it wrote its first segment has kept nothing."""
    target = tmp_path / "out.nc"
    left = tmp_path / "out.segments"
    left.mkdir()
    (left / "segment_0.nc").write_bytes(b"half of it")
    with pytest.raises(InputError, match="killed before the first was whole; the next run"):
        recover(left)
    lock = Lock(left)
    lock.take()
    with pytest.raises(OutputError, match="holds the rows of another run"):
        prepare(target)
    lock.release()
    prepare(target)
    assert not left.exists()


def test_nothing_to_recover_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no segments of a run here"):
        recover(tmp_path / "none.segments")


def test_last_stretch_and_decimation(library: Path) -> None:
    """The last two of four cycles, every third row; the steps do not change."""
    record = {"last": "2 cycles", "every": 3}
    all_rows = run(load("oscillator-1", None, library, time={"stop": "4 cycles"}))
    plan = load("oscillator-1", None, library, time={"stop": "4 cycles"}, record=record)
    done = run(plan)
    assert done.steps == all_rows.steps
    kept = np.flatnonzero(np.isin(all_rows.times, done.times))
    assert np.array_equal(kept % 3, np.zeros(len(kept)))
    assert done.times[0] >= 2.0 / (plan.frequency or 1.0) - 1e-9
    assert np.array_equal(done.rows, all_rows.rows[kept])


@pytest.mark.parametrize("closed", [0, 1])
def test_a_signal_amid_a_segment_leaves_none_half(
    closed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The rows are still in memory; without a whole segment there is no folder."""
    made = segments.Segments(tmp_path / "out.segments", [], {})
    times, rows = np.arange(3.0), np.zeros((3, 1))
    for _ in range(closed):
        made.write(times, rows)

    def struck(path: Path, times: object, rows: object) -> None:
        path.write_bytes(b"half")
        raise Interrupted(signal.SIGINT)

    monkeypatch.setattr(segments, "_write_piece", struck)
    with pytest.raises(Interrupted):
        made.write(times, rows)
    left = sorted(path.name for path in tmp_path.rglob("*.nc*"))
    assert left == ["000000.nc"] * closed
    assert made.folder.exists() == bool(closed)
    assert len(made.digests) == closed
    made.remove()
