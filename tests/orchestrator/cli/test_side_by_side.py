"""Runs side by side: names of results, `compare`, `plot` of several."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import xarray
from typer.testing import CliRunner, Result

from orchestrator.cli import app
from orchestrator.errors import KeptWarning
from orchestrator.results.segments import Column, assemble

SHORT = ("--stop", "4 cycles", "--step", "40 per cycle", "--no-picture", "--quiet")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def resilin(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "80"})


def run(library: Path, *options: str) -> Result:
    return resilin("run", "oscillator-1", "--fmus", library, *SHORT, *options)


@pytest.fixture
def two(library: Path, desk: Path) -> Path:
    """Two results, of the shipped mass and of a heavier one."""
    assert run(library).exit_code == 0
    assert run(library, "--name", "heavy", "--set", "payload.mass=0.7 g").exit_code == 0
    return desk / "results"


def test_a_name_is_that_of_the_result(two: Path, library: Path) -> None:
    assert sorted(path.name for path in two.iterdir()) == ["heavy.nc", "oscillator-1.nc"]
    for name in ("a/b", "..", ""):
        refused = run(library, "--name", name)
        assert refused.exit_code == 2
        assert "is not the name of a file" in refused.stderr
    assert "give one" in run(library, "--name", "a", "--output", "b.nc").stderr


def test_a_result_of_another_setting_is_not_overwritten(two: Path, library: Path) -> None:
    """One of the same setting is, and one at a path that is given."""
    before = (two / "oscillator-1.nc").stat().st_mtime_ns
    assert run(library).exit_code == 0
    assert len(list(two.iterdir())) == 2
    with pytest.warns(KeptWarning):
        assert run(library, "--set", "payload.mass=0.8 g").exit_code == 0
    (kept,) = two.glob("oscillator-1.*.nc")
    assert kept.stat().st_mtime_ns > before
    for name, mass in ((kept.name, "0.603 g"), ("oscillator-1.nc", "0.8 g")):
        with xarray.open_dataset(two / name) as data:
            assert mass in data.attrs["scenario"]
    assert run(library, "--output", "results/heavy.nc").exit_code == 0
    assert len(list(two.iterdir())) == 3


def test_compare_shows_metrics_and_differences(two: Path) -> None:
    pair = (two / "oscillator-1.nc", two / "heavy.nc")
    done = resilin("compare", *pair, "--output", "both.svg")
    assert done.exit_code == 0, done.output
    for word in ("travel", "change", "payload.displacement", "heavy minus oscillator-1"):
        assert word in done.output
    assert max(map(len, done.output.splitlines())) <= 80
    assert (two.parent / "both.svg").read_text().startswith("<?xml")
    facts = json.loads(resilin("compare", *pair, "--json").stdout)
    travel = facts["metrics"]["travel"]
    assert travel["unit"] == "m"
    assert travel["change"] == pytest.approx(travel["values"][1] / travel["values"][0] - 1.0)
    assert facts["differences"]["payload.displacement"]["largest"] > 0.0
    same = json.loads(
        resilin("compare", pair[0], pair[0].parent / "../results/oscillator-1.nc", "--json").stdout
    )
    assert {each["largest"] for each in same["differences"].values()} == {0.0}
    assert resilin("compare", pair[0], pair[0]).exit_code == 2


def test_what_was_changed_is_shown(two: Path) -> None:
    """Beside the title, and between two results, whose equal settings are not listed."""
    rows = " ".join(resilin("results").stdout.replace("│", " ").split())
    assert "payload.mass = 0.7 g" in rows and "time.stop = 4 cycles" in rows
    facts = json.loads(resilin("compare", "oscillator-1", "heavy", "--json").stdout)
    assert facts["settings"] == {"payload.mass": ["0.603 g", "0.7 g"]}
    shown = resilin("compare", "oscillator-1", "heavy").stdout
    assert "│ payload.mass │ 0.603 g      │ 0.7 g │" in shown


def test_results_are_found_by_name(two: Path) -> None:
    (listed,) = json.loads(resilin("results", "heavy", "--json").stdout)
    assert listed["result"] == "results/heavy.nc"
    assert resilin("plot", "heavy", "oscillator-1.nc").exit_code == 0
    assert (two / "heavy-oscillator-1.png").is_file()
    for command in (("compare", "heavy"), ("plot",), ("results",)):
        for wrong in ("havy", "results/havy.nc"):
            refused = resilin(*command, wrong)
            assert refused.exit_code == 2
            assert refused.stderr == f"resilin: {wrong}: no such result; did you mean 'heavy'?\n"


def test_texts_are_compared(desk: Path) -> None:
    times = np.linspace(0.0, 1.0, 11)
    for name, moment in (("a", 0.35), ("b", 0.55)):
        column = Column("relay.state", {}, [(0.0, "shut"), (moment, "open\x1b")])
        noted = {"texts": '["relay.state"]'}
        assemble(Path(f"{name}.nc"), [column], noted, iter([(times, np.zeros((11, 0)))]))
    done = resilin("compare", "a.nc", "b.nc")
    assert done.exit_code == 0, done.output
    assert "│ relay.state │       0.2 s │    0.4 s │ 'open\\x1b' │ 'shut' │" in done.output
    facts = json.loads(resilin("compare", "a.nc", "b.nc", "--json").stdout)
    assert facts["texts"]["relay.state"] == {
        "apart": pytest.approx(0.2), "first": 0.4, "then": ["open\x1b", "shut"]
    }  # fmt: skip


def test_a_run_that_records_nothing_shows_no_empty_table(desk: Path, library: Path) -> None:
    (desk / "mute.toml").write_text(
        'extends = "oscillator-1"\ntime.stop = "1 cycles"\n'
        "[record]\ninherit = false\nvariables = []\n"
    )
    done = resilin("run", "mute.toml", "--fmus", library)
    assert done.exit_code == 0, done.output
    assert "┃" not in done.output and "result: results/mute.nc" in done.output
    assert [path.name for path in (desk / "results").iterdir()] == ["mute.nc"]
    refused = resilin("plot", "results/mute.nc")
    assert refused.exit_code == 2 and "nothing to draw" in refused.stderr


def test_plot_draws_runs_over_each_other(two: Path) -> None:
    pair = (two / "oscillator-1.nc", two / "heavy.nc")
    done = resilin("plot", *pair)
    assert done.exit_code == 0, done.output
    assert (two / "oscillator-1-heavy.png").is_file()
    wrong = resilin("plot", *pair, "--variable", "payload.displacment")
    assert wrong.exit_code == 2
    assert "did you mean 'payload.displacement'" in wrong.stderr


def test_texts_in_tables_and_settings_of_plots_are_not_obeyed(two: Path, desk: Path) -> None:
    """Brackets are no markup, and what a matplotlibrc has set changes no plot."""
    (two / "heavy.nc").rename(two / "[red]heavy.nc")
    pair = ("results/oscillator-1.nc", "results/[red]heavy.nc")
    assert "[red]heavy" in resilin("results").stdout
    shown = resilin("compare", *pair, "--output", "plain.svg")
    assert shown.exit_code == 0, shown.output
    assert "[red]heavy" in shown.stdout
    for name in ("plain.png", "again.png"):
        with matplotlib.rc_context({"figure.facecolor": "red" if name == "again.png" else "white"}):
            assert resilin("plot", *pair, "--output", name).exit_code == 0
    assert (desk / "plain.png").read_bytes() == (desk / "again.png").read_bytes()
