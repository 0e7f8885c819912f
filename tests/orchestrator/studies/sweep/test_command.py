"""A sweep on the command line: its table, its file in a list, its plot."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from orchestrator.cli import app
from orchestrator.errors import KeptWarning

PATH = Path("results/oscillator-1.sweep.nc")


def resilin(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "80"})


def sweep(cluster: Any, library: Path, *axes: str) -> Result:
    options = ["--stop", "4 cycles", "--step", "40 per cycle", "--fmus", str(library)]
    over = [text for axis in axes for text in ("--over", axis)]
    return resilin(
        "sweep", "oscillator-1", *over, *options, "--scheduler", cluster.scheduler_address
    )


def test_a_sweep_is_swept_listed_and_drawn(
    cluster: Any, library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = sweep(cluster, library, "amplifier.frequency=48,52Hz", "payload.mass=0.6,0.7g")
    assert done.exit_code == 0, done.output
    assert max(map(len, done.output.splitlines())) <= 80
    drawn = resilin("plot", PATH)
    assert drawn.exit_code == 0, drawn.output
    assert PATH.with_suffix(".png").is_file()
    assert "which has no time" in resilin("plot", PATH, "--cycles", "3").stderr
    assert "no such result" in resilin("compare", PATH, PATH.with_name("other.nc")).stderr
    listed = json.loads(resilin("results", "--json").stdout)
    assert [(e["result"], e["kind"], e["extent"]) for e in listed] == [
        (str(PATH), "sweep", "2 x 2 points")
    ]
    shown = resilin("results")
    assert PATH.name in shown.output and "2 x 2 points" in shown.output


def test_a_sweep_of_other_points_is_not_overwritten(
    cluster: Any, library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert sweep(cluster, library, "amplifier.frequency=48,52Hz").exit_code == 0
    assert sweep(cluster, library, "amplifier.frequency=48,52Hz").exit_code == 0
    assert len(list(PATH.parent.iterdir())) == 1
    with pytest.warns(KeptWarning):
        assert sweep(cluster, library, "amplifier.frequency=48,53Hz").exit_code == 0
    assert len(list(PATH.parent.iterdir())) == 2


def test_an_empty_folder_has_no_results(tmp_path: Path) -> None:
    assert resilin("results", tmp_path).output == f"no results in {tmp_path}\n"
