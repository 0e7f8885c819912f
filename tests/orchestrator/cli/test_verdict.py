"""That the numbers of a run say nothing is told wherever they are shown."""

from __future__ import annotations

import json
from pathlib import Path

import lxml.html
import pytest
import xarray
from typer.testing import CliRunner, Result

from orchestrator.cli import app
from tests.foreign.scenarios import Shelf, populations

SAID = "these numbers say nothing"


def resilin(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments), env={"COLUMNS": "300"})


@pytest.fixture
def judged(shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a run with a step far too long, and of a page of it."""
    monkeypatch.setattr("orchestrator.simulation.run.BUDGET", 600.0)
    monkeypatch.chdir(tmp_path)
    path = populations(tmp_path, shelf, '[master]\nkind = "gauss-seidel"', step=0.1)
    place = ["--name", "bad", "--html", "bad.html", "--no-picture"]
    done = resilin("run", str(path), *place, "--set", "prey.growth=1.4")
    assert done.exit_code == 1 and SAID in done.stderr
    with xarray.open_dataset("results/bad.nc") as data:
        data.load().assign_attrs(verdict="", dropped='["a wire"]').to_netcdf("results/good.nc")
    return tmp_path


def test_a_verdict_stands_on_the_page_in_the_file_and_in_lists(judged: Path) -> None:
    page = lxml.html.fromstring((judged / "bad.html").read_text())
    (alarm,) = page.find_class("alarm")
    assert SAID in alarm.text_content()
    (lead,) = page.find_class("lead")
    assert "With prey.growth = 1.4." in lead.text_content()
    with xarray.open_dataset("results/bad.nc") as data:
        known = dict(data.attrs)
    assert SAID in known["verdict"] and known["complete"] == 1
    assert json.loads(known["changes"]) == {"prey.growth": "1.4"}
    lines = {"bad": resilin("results", "bad").stdout, "good": resilin("results", "good").stdout}
    assert {name: SAID in line for name, line in lines.items()} == {"bad": True, "good": False}
    assert all("with prey.growth = 1.4" in line for line in lines.values())
    compared = resilin("compare", "good", "bad").stdout
    first, second, *_ = compared.splitlines()
    assert first == "good: dropped: a wire"
    assert second.startswith("bad: NOT TO BE USED: ") and SAID in second
    assert "settings that differ" not in compared
    facts = json.loads(resilin("compare", "good", "bad", "--json").stdout)
    assert SAID in facts["notes"]["bad"]["verdict"] and not facts["notes"]["good"]["verdict"]
    assert resilin("plot", "bad", "--output", "bad.svg").exit_code == 0
    assert "NOT TO BE USED" in (judged / "bad.svg").read_text()
