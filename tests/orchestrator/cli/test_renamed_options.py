"""Options by the names of earlier releases."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import RenamedWarning

runner = CliRunner()


@pytest.mark.parametrize("option", ["--diagram wires.svg", "--diagram=wires.svg"])
def test_an_old_name_does_the_same_and_names_the_new_one(
    option: str, library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    line = ["inspect", "oscillator-1", "--fmus", str(library), *option.split()]
    with pytest.warns(RenamedWarning, match="--diagram is now called --output"):
        done = runner.invoke(app, line)
    assert done.exit_code == 0, done.output
    assert Path("wires.svg").is_file()


@pytest.mark.parametrize(
    ("line", "old", "new"),
    [
        ("linearise nowhere --bode a.svg", "bode", "output"),
        ("export nowhere --to a.ssp", "to", "output"),
        ("export nowhere --also a:b.c=1", "also", "parameter-set"),
        ("fit nowhere --part a --parameters b", "parameters", "parameter"),
        ("fit nowhere --part a --parameter b --picture a.svg", "picture", "output"),
        ("fit nowhere --part a --parameter b --scene c", "scene", "scenario"),
        ("calibrate --file nowhere", "file", "fits"),
        ("paper nowhere --no-pictures", "no-pictures", "no-picture"),
    ],
)
def test_every_old_name_is_understood(line: str, old: str, new: str) -> None:
    with pytest.warns(RenamedWarning, match=f"--{old} is now called --{new};"):
        done = runner.invoke(app, line.split())
    assert done.exit_code == 2
    assert "nowhere" in done.output
    assert "No such option" not in done.output


def test_a_variable_in_the_place_of_a_file_is_told_its_option(library: Path) -> None:
    """`--output` of `linearise` and `fit` was a variable."""
    line = ["linearise", "oscillator-1", "--fmus", str(library), "--output", "payload.displacement"]
    done = runner.invoke(app, line)
    assert done.exit_code == 2
    assert "--variable" in done.output
