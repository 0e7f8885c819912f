"""What asks for a package of the extra `studies`, where there is none."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError
from orchestrator.results.netcdf import dataset
from tests.conftest import Runner

PROCESSES = ("distributed", "cryptography")
SWEEP = ("sweep", "oscillator-1", "--over", "amplifier.frequency=48:54:2Hz")
POLES = ("linearise", "oscillator-1", "--output", "bode.svg", "--interval", "1 cycle")


def lacks(monkeypatch: pytest.MonkeyPatch, *packages: str) -> None:
    for name in packages:
        monkeypatch.setitem(sys.modules, name, None)


@pytest.mark.parametrize(
    ("packages", "command", "purpose"),
    [
        (["xarray"], SWEEP, "a sweep needs xarray"),
        (["xarray"], ["plot", "sweep.nc"], "a plot of a sweep needs xarray"),
        (["xarray"], [*POLES, "--beside", "sweep.nc"], "a sweep beside a response needs xarray"),
        (PROCESSES, [*SWEEP, "--workers", "2"], "processes needs distributed and cryptography"),
        (["cryptography"], ["paper", "table1"], "processes needs cryptography"),
    ],
)
def test_a_command_names_what_it_needs(
    packages: list[str],
    command: list[str],
    purpose: str,
    library: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    xarray.Dataset(attrs={"axes": "[]"}).to_netcdf("sweep.nc")
    lacks(monkeypatch, *packages)
    given = [] if command[0] == "plot" else ["--fmus", str(library)]
    done = CliRunner().invoke(app, [*command, *given])
    assert done.exit_code == 2
    assert done.stderr.startswith("resilin: ")
    assert done.stderr.endswith(f"{purpose}: pip install 'resilin[studies]'\n")
    assert done.stderr.count("\n") == 1


def test_a_short_sweep_needs_no_processes(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lacks(monkeypatch, *PROCESSES, "dask")
    done = CliRunner().invoke(app, [*SWEEP, "--stop", "4 cycles", "--fmus", str(library)])
    assert done.exit_code == 0, done.output


def test_a_dataset_names_what_it_needs(outcome: Runner, monkeypatch: pytest.MonkeyPatch) -> None:
    found = outcome("oscillator-1", time={"stop": "1 cycle"})
    lacks(monkeypatch, "xarray")
    with pytest.raises(InputError, match=r"a dataset needs xarray: pip install"):
        dataset(found)
