"""Results and printed lines of a run, for any names, streams and folders."""

from __future__ import annotations

import json
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
from orchestrator.results.recorded import read_recorded
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


def test_an_older_result_stays_until_a_new_one_is_whole(desk: Path, library: Path) -> None:
    assert invoke(library, "good.toml")[0] == 0
    older = (desk / "out.nc").read_bytes()
    fault = '\n[[faults]]\nat = "5 ms"\non = "payload"\nkind = "drop"\n'
    (desk / "bad.toml").write_text((desk / "good.toml").read_text() + fault)
    code, lines, _ = invoke(library, "bad.toml")
    assert code == 1
    assert lines[0].endswith("out.nc is still the result of an earlier run")
    assert (desk / "out.nc").read_bytes() == older
    assert (desk / "out.partial.nc").exists()
    assert invoke(library, "good.toml")[0] == 0
    assert sorted(p.name for p in desk.glob("out*")) == ["out.nc"]


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


def renamed(desk: Path, library: Path, **names: str) -> None:
    """A scenario `own.toml` of a payload some of whose outputs have other names."""

    def text(entry: str) -> bytes:
        data = old.read(entry)
        if entry == "modelDescription.xml":
            for own, name in names.items():
                data = data.replace(f'"{own}"'.encode(), f'"{name}"'.encode())
        return data

    with (
        zipfile.ZipFile(library / "payload.fmu") as old,
        zipfile.ZipFile(desk / "own.fmu", "w") as new,
    ):
        for entry in old.namelist():
            new.writestr(entry, text(entry))
    (desk / "own.toml").write_text(changed(PART, 'fmu = "own.fmu"\nisolate = true'))


def test_names_that_netcdf_takes_for_one_are_two(desk: Path, library: Path) -> None:
    """It composes characters: e and an accent, and the one letter."""
    renamed(desk, library, kinetic_energy="\u00e9", force_work="e\u0301")
    code, lines, _ = invoke(library, "own.toml")
    assert (code, lines) == (0, [])
    names = set(read_recorded(desk / "out.nc").series)
    assert {"payload.\u00e9", "payload.e\u0301"} <= names


@pytest.mark.parametrize("name", ["a[/b]", "a[red]", ":smile:", "$x$", "a$b$c$d", r"\$x^{", "_a"])
def test_name_stands_as_it_is_in_tables_and_plots(name: str, desk: Path, library: Path) -> None:
    """Neither markup of the terminal, nor a formula of the plot."""
    renamed(desk, library, displacement=name)
    pattern = json.dumps("payload." + name.replace("[", "[[]"))
    metric = json.dumps(f"last({json.dumps(f'payload.{name}')})")
    with (desk / "own.toml").open("a") as file:
        file.write(f"\n[plot]\n{json.dumps(f'$Panel$ {name}')} = {pattern}\n")
        file.write(f"\n[metrics]\n{json.dumps(name)} = {metric}\n")
    options = ["--fmus", str(library), "--estimate", "--verbose", "--output", "out.nc"]
    result = CliRunner().invoke(cli.app, ["run", "own.toml", *options])
    assert result.exception is None, result.stderr
    assert name in result.stdout
    assert (desk / "out.png").exists()


@pytest.mark.parametrize(
    "name", ["lift/drag", "n" * 400, "翼" * 200, " lift ", "1 lift", "der(x)[1]", "'a.b'"]
)
def test_name_that_netcdf_does_not_take_is_kept(name: str, desk: Path, library: Path) -> None:
    renamed(desk, library, kinetic_energy=name)
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
