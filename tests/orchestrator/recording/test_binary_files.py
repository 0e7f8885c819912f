"""Damaged binary files, and small ones that unpack to more than is allowed."""

from __future__ import annotations

import signal
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from scipy.io import savemat

from orchestrator.errors import RecordingError
from orchestrator.recording import binary_process
from orchestrator.recording.columns import Choice
from orchestrator.recording.read import LARGEST, read_table

ROWS = np.linspace(0.0, 1.0, 1000)


def netcdf(path: Path, rows: int = len(ROWS)) -> Path:
    coded = {"zlib": True, "fletcher32": True, "chunksizes": (100,)}
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", rows)
        for name in ("time", "y", "z"):
            variable = file.createVariable(name, "f8", ("time",), **coded)
            if rows == len(ROWS):
                variable[:] = np.sin(7.0 * ROWS) if name != "time" else ROWS
    return path


def test_a_damaged_chunk_is_refused_with_its_column(tmp_path: Path) -> None:
    """Found only when its values are read; columns that are not used may be damaged."""
    path = netcdf(tmp_path / "bench.nc")
    data = path.read_bytes()
    damaged = data[: len(data) // 2] + bytes(len(data) // 2)
    path.write_bytes(damaged)
    with pytest.raises(RecordingError, match=r"bench\.nc: '[yz]' cannot be read \("):
        read_table(path, Choice())


def test_a_netcdf_file_is_as_large_as_it_declares(tmp_path: Path) -> None:
    path = netcdf(tmp_path / "bomb.nc", rows=150_000_000)
    assert path.stat().st_size < 100_000
    with pytest.raises(RecordingError, match=r"150000000 rows of 3 columns unpack to .* memory"):
        read_table(path, Choice())


def test_a_parquet_file_is_as_large_as_it_declares(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "bomb.parquet"
    still = np.zeros(200_000)
    parquet.write_table(pyarrow.table({"time": still, "y": still}), path)
    assert path.stat().st_size < 10_000
    with pytest.raises(RecordingError, match=r"200000 rows of 2 columns unpack to .* memory"):
        read_table(path, Choice(), most=1 << 20)


def test_a_matlab_file_is_as_large_as_it_unpacks(tmp_path: Path) -> None:
    path = tmp_path / "bomb.mat"
    savemat(path, {"t": np.zeros(1_000_000), "y": np.zeros(1_000_000)}, do_compression=True)
    assert path.stat().st_size < 50_000
    with pytest.raises(RecordingError, match=r"1000000 rows of 2 columns unpack to .* memory"):
        read_table(path, Choice(), most=1 << 20)


def test_a_matlab_file_whose_reader_crashes_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """scipy reads beyond its memory in some damaged files: its process ends, not this one."""
    reader = tmp_path / "reader.py"
    reader.write_text(f"import os\nos.kill(os.getpid(), {int(signal.SIGSEGV)})\n")
    monkeypatch.setattr(binary_process, "READER", reader)
    path = tmp_path / "bench.mat"
    savemat(path, {"t": ROWS, "y": ROWS})
    with pytest.raises(RecordingError, match=r"bench\.mat: .* \(its reader crashed"):
        read_table(path, Choice())


def test_a_damaged_compressed_matlab_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bench.mat"
    savemat(path, {"t": ROWS, "y": np.sin(ROWS)}, do_compression=True)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0x10
    path.write_bytes(data)
    with pytest.raises(RecordingError, match=r"bench\.mat: cannot be read as a MATLAB file"):
        read_table(path, Choice(), most=LARGEST)
