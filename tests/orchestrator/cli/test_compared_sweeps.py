"""`compare` and `plot` of sweeps, and of results that do not go together."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from orchestrator.cli import app
from orchestrator.results.segments import Column, assemble
from orchestrator.studies.sweep.dataset import write
from tests.orchestrator.studies.sweep.flat import FREQUENCY, MASS, flat


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two sweeps over a frequency, and the result of a run."""
    monkeypatch.chdir(tmp_path)
    write(flat({FREQUENCY: [48.0, 50.0, 52.0]}, lambda f: 1e-4 * f, gain=2.0), Path("a.nc"))
    write(flat({FREQUENCY: [50.0, 52.0, 54.0]}, lambda f: 1.1e-4 * f), Path("b.nc"))
    rows = np.zeros((2, 1)), np.array([0.0, 1.0])
    assemble(Path("run.nc"), [Column("p.x", {"units": "m"})], {}, iter([(rows[1], rows[0])]))
    return tmp_path


def resilin(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments), env={"COLUMNS": "80"})


def test_two_sweeps_are_compared(desk: Path) -> None:
    done = resilin("compare", "a.nc", "b.nc", "--output", "ab.svg")
    assert done.exit_code == 0, done.output
    assert max(map(len, done.output.splitlines())) <= 80
    for words in (
        "b minus a, at 2 points",
        "0.52 mm │      0.1 │ 0.51 mm │         52 │",
        f"{FREQUENCY} 48 Hz: only in a",
        f"{FREQUENCY} 54 Hz: only in b",
        "not in b: gain",
    ):
        assert words in done.output
    assert (desk / "ab.svg").is_file()
    facts = json.loads(resilin("compare", "a.nc", "b.nc", "--json").stdout)
    assert facts["results"] == ["a.nc", "b.nc"]
    assert facts["axes"] == {FREQUENCY: {"unit": "Hz", "values": [50.0, 52.0]}}
    assert facts["alone"] == {FREQUENCY: [[48.0], [54.0]]}
    assert facts["missing"] == {"a": [], "b": ["gain"]}
    travel = facts["differences"]["travel"]
    assert travel["largest"] == pytest.approx(0.52e-3)
    assert (travel["at"], travel["points"], travel["unit"]) == ({FREQUENCY: 52.0}, 2, "m")


def test_four_axes_and_long_names_fit_a_terminal(desk: Path) -> None:
    axes = {FREQUENCY: [48.0, 50.0], MASS: [1e-3, 2e-3], "p.third": [1.0, 2.0], "p.q": ["up", "on"]}
    for name, rise in (("c", 0.0), ("d", 1.0)):
        metrics = {"x" * 60: 1.0 + rise}
        write(flat(axes, lambda *p, rise=rise: p[0] + rise * p[1], **metrics), Path(f"{name}.nc"))
    done = resilin("compare", "c.nc", "d.nc")
    assert done.exit_code == 0, done.output
    assert max(map(len, done.output.splitlines())) <= 80
    assert "…" not in done.output


def test_a_run_and_a_sweep_are_refused(desk: Path) -> None:
    for command in ("compare", "plot"):
        done = resilin(command, "a.nc", "run.nc")
        assert done.exit_code == 2
        assert "run.nc is a run over time, a.nc a sweep" in done.stderr


def test_sweeps_are_drawn_over_each_other(desk: Path) -> None:
    done = resilin("plot", "a.nc", "b.nc")
    assert done.exit_code == 0, done.output
    assert done.output == "plot: a-b.png\n"
    assert (desk / "a-b.png").is_file()


def test_a_damaged_sweep_is_refused(desk: Path) -> None:
    path = desk / "a.nc"
    data = bytearray(path.read_bytes())
    for k in range(len(data) // 3, len(data), 50):
        data[k] ^= 0xFF
    path.write_bytes(data)
    for command in (["plot", "a.nc"], ["compare", "a.nc", "b.nc"]):
        done = resilin(*command)
        assert isinstance(done.exception, SystemExit), done.exception
        assert done.exit_code == 2
        assert "a.nc" in done.stderr
