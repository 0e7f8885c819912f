"""Results and printed lines of a run, for any names, streams and folders."""

from __future__ import annotations

import os
import subprocess
import tempfile
import zipfile
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.results import netcdf
from tests.orchestrator.good_scenario import PART, Refuse, changed, invoke
from tests.processes import resilin


def test_good_scenario_runs_and_leaves_nothing(desk: Path, library: Path) -> None:
    code, lines, error = invoke(library, "good.toml")
    assert (code, lines, error) == (0, [], None)
    assert [p.name for p in desk.iterdir() if p.name != "good.toml"] == ["out.nc"]
    assert list(Path(tempfile.gettempdir()).iterdir()) == []


def test_no_place_for_temporary_files_is_refused(
    desk: Path, library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", "/proc")
    code, lines, error = invoke(library, "good.toml")
    assert isinstance(error, SystemExit), f"raw exception {error!r}"
    assert code in {1, 2}
    assert len(lines) == 1
    assert "TMPDIR" in lines[0]


def test_plot_that_cannot_be_drawn_keeps_the_result(desk: Path, library: Path) -> None:
    (desk / "out.png").mkdir()
    code, lines, error = invoke(library, "good.toml", "--picture")
    assert isinstance(error, SystemExit), f"raw exception {error!r}"
    assert code in {1, 2}
    assert len(lines) == 1
    assert "out.png" in lines[0]
    assert (desk / "out.nc").exists()


@pytest.mark.parametrize("name", ["out[/red].nc", "[bold]out.nc", "out\nline.nc"])
def test_name_of_the_result_is_shown_as_it_is(name: str, desk: Path, library: Path) -> None:
    options = ["--fmus", str(library), "--no-picture", "--output", f"./{name}"]
    (desk / name).parent.mkdir(exist_ok=True)
    result = CliRunner().invoke(cli.app, ["run", "good.toml", *options])
    assert result.exception is None
    assert result.exit_code == 0
    assert name.replace("\n", "\\x0a") in result.stdout


@pytest.mark.parametrize("error", [RuntimeError("NetCDF: HDF error"), OSError(28, "No space left")])
def test_result_that_cannot_be_written_is_refused(
    error: Exception, refuse: Refuse, monkeypatch: pytest.MonkeyPatch
) -> None:
    """netCDF4 reports a full disk as a RuntimeError."""

    def full(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr(netcdf, "assemble", full)
    (line,) = refuse("good.toml")
    assert "out.nc: cannot be written" in line


@pytest.mark.parametrize(
    "name", ["lift/drag", "n" * 400, "翼" * 200, " lift ", "1 lift", "der(x)[1]", "'a.b'"]
)
def test_name_that_netcdf_does_not_take_is_kept(name: str, desk: Path, library: Path) -> None:
    def text(entry: str) -> bytes:
        data = old.read(entry)
        if entry == "modelDescription.xml":
            data = data.replace(b'"kinetic_energy"', f'"{name}"'.encode())
        return data

    with (
        zipfile.ZipFile(library / "payload.fmu") as old,
        zipfile.ZipFile(desk / "own.fmu", "w") as new,
    ):
        for entry in old.namelist():
            new.writestr(entry, text(entry))
    (desk / "own.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    code, lines, _ = invoke(library, "own.toml")
    assert (code, lines) == (0, [])
    with xarray.open_dataset("out.nc") as data:
        known = {*data.data_vars, *(str(a) for v in data.values() for a in v.attrs.values())}
    assert f"payload.{name}" in known


def test_output_that_cannot_be_printed_raises_nothing(desk: Path, library: Path) -> None:
    arguments = resilin("run", "good.toml", "--fmus", library, "--no-picture")
    ascii_only = {**os.environ, "PYTHONIOENCODING": "ascii"}
    poor = subprocess.run([*arguments, "--output", "ü翼.nc"], env=ascii_only, capture_output=True)
    assert (poor.returncode, poor.stderr) == (0, b"")
    with Path("/dev/full").open("w") as full:
        stuck = subprocess.run(arguments, stdout=full, stderr=subprocess.PIPE)
    assert stuck.returncode == 1
    assert stuck.stderr.startswith(b"resilin: ")
    assert b"Traceback" not in stuck.stderr


@pytest.mark.parametrize("name", ["a b", "jürgen", "o'neill", "50%", "a%20b", "a#b", "a?b", "翼"])
def test_any_folder_for_temporary_files_will_do_or_is_refused(
    name: str, desk: Path, library: Path
) -> None:
    """In a process of its own: an FMU that misreads its folder may take the process down."""
    temporary = desk.parent / name
    temporary.mkdir()
    process = subprocess.run(
        resilin("run", "good.toml", "--fmus", library, "--no-picture", "--output", "out.nc"),
        env={**os.environ, "TMPDIR": str(temporary)},
        capture_output=True,
        text=True,
    )
    refused = process.returncode == 2 and "TMPDIR" in process.stderr
    assert refused or process.returncode == 0, process.stderr
    assert list(temporary.iterdir()) == []
