"""Results that are read again: damaged, declared larger than they are, or not there."""

from __future__ import annotations

from pathlib import Path

import netCDF4
import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError
from orchestrator.results.recorded import read_recorded
from orchestrator.results.segments import Column, assemble

ROWS = np.linspace(0.0, 1.0, 2000)


def result(path: Path, unit: str = "m") -> Path:
    columns = [Column("p.x", {"units": unit}), Column("p.v", {"units": "m/s"})]
    rows = np.column_stack([np.sin(7.0 * ROWS), np.cos(7.0 * ROWS)])
    assemble(path, columns, {"title": "Pushed"}, iter([(ROWS, rows)]))
    return path


def test_a_damaged_variable_is_reported_with_its_file(tmp_path: Path) -> None:
    path = result(tmp_path / "run.nc")
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2] + bytes(len(data) // 2))
    with pytest.raises(InputError, match=r"run\.nc: 'p\.[xv]' cannot be read \("):
        read_recorded(path)


def test_plot_of_a_damaged_result_is_refused(tmp_path: Path) -> None:
    path = result(tmp_path / "run.nc")
    data = bytearray(path.read_bytes())
    data[len(data) * 2 // 3 : len(data) * 2 // 3 + 40] = bytes(40)
    path.write_bytes(data)
    done = CliRunner().invoke(app, ["plot", str(path)])
    assert isinstance(done.exception, SystemExit)
    assert done.exit_code == 2
    assert "run.nc" in done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


@pytest.mark.parametrize("name", ["none.nc", "x" * 5000, "a\0b", "/dev/null/x.nc"])
def test_a_path_without_a_result_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such result"):
        read_recorded(tmp_path / name)


def test_rows_that_a_file_only_declares_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 200_000_000)
        for name in ("time", "p.x"):
            file.createVariable(name, "f8", ("time",), zlib=True)
    with pytest.raises(InputError, match="too small for the 200000000 rows"):
        read_recorded(path)


def test_still_values_are_no_bomb(tmp_path: Path) -> None:
    path = tmp_path / "still.nc"
    count = 300_000
    columns = [Column(f"p.x{k}", {}) for k in range(20)]
    assemble(path, columns, {}, iter([(np.arange(float(count)), np.zeros((count, 20)))]))
    assert len(read_recorded(path).times) == count


def test_units_are_no_dates(tmp_path: Path) -> None:
    """Values of a variable whose unit reads like that of a date stand as they are."""
    read = read_recorded(result(tmp_path / "run.nc", unit="days since 2000-01-01"))
    np.testing.assert_array_equal(read.series["p.x"], np.sin(7.0 * ROWS))
