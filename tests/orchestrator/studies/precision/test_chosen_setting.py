"""`precision --use`: the scenario that it writes runs as the study's run did."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.errors import InputError, OutputError
from orchestrator.simulation.load import load
from orchestrator.studies.precision.chosen_setting import write_setting
from orchestrator.studies.precision.study import precision
from tests.foreign.scenarios import Shelf, masses


def test_the_written_scenario_is_the_studied_setting(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = masses(tmp_path, shelf)
    arguments = ["precision", str(path), "--factor", "1", "--factor", "0.25", "--repeats", "1"]
    arguments += ["--method", "gauss-seidel", "--method", "interface-newton"]
    arguments += ["--use", "1e-3", "--set", "a.start_displacement=0.5", "--stop", "1 s"]
    result = CliRunner().invoke(cli.app, arguments)
    assert result.exit_code == 0, result.output
    assert "scenario: scenario-0.001.toml" in result.stdout
    plan = load(tmp_path / "scenario-0.001.toml")
    assert plan.scenario.master.kind == "interface-newton"
    assert plan.grid.stop == 1.0
    assert plan.starts["a"]["start_displacement"] == 0.5
    text = (tmp_path / "scenario-0.001.toml").read_text()
    assert text.startswith("# interface-newton, curvature: error ")
    assert f"step = {plan.grid.step!r}" in text
    again = CliRunner().invoke(cli.app, arguments)
    assert again.exit_code == 2
    assert "scenario-0.001.toml: is there already; move it away" in again.stderr


def test_a_target_that_nothing_reaches_is_refused(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = masses(tmp_path, shelf)
    study = precision(path, methods=["gauss-seidel"], factors=[1.0], repeats=1)
    with pytest.raises(InputError, match=r"--use 1e-06: no setting reaches it; the least error is"):
        write_setting(study, str(path), 1e-6)
    with pytest.raises(OutputError, match="is there already"):
        (tmp_path / "scenario-1.toml").touch()
        write_setting(study, str(path), 1.0)
