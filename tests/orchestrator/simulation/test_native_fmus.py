"""Scenarios on native parts: the same result bit by bit, from one option."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import FmuError
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.reference.monolith import monolithic


@pytest.mark.parametrize(
    ("scenario", "kind"),
    [
        ("oscillator-1", "interface-newton"),
        ("flapping-full-wings", "gauss-seidel"),
        ("flapping-spring-full-wings", "gauss-seidel"),
    ],
)
def test_a_scenario_gives_the_same_bits(
    python_parts: Path, native: Path, scenario: str, kind: str
) -> None:
    both = [
        run(load(scenario, None, parts, time={"stop": "1 cycles"}, master={"kind": kind}))
        for parts in (python_parts, native)
    ]
    first, second = both
    assert first.failure is None
    assert first.names == second.names
    for name in first.names:
        assert np.array_equal(first.series(name), second.series(name), equal_nan=True), name


def invoke(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output


def test_the_option(native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("orchestrator.scenario.library.CHECKOUT", tmp_path)
    Path("build").mkdir()
    Path("mine.toml").write_text('extends = "flapping-full-wings"\n')
    scenario = ("mine.toml", "--native", "--stop", "1 cycles")
    code, output = invoke("run", *scenario)
    assert code == 2
    assert "resilin build --native" in output.replace("\n", " ")
    Path("build/native").symlink_to(native)
    code, output = invoke("run", *scenario, "--no-picture")
    assert (code, "stroke" in output) == (0, True)
    code, output = invoke("run", *scenario, "--no-picture", "--fmus", str(tmp_path / "build"))
    assert code == 0, output
    code, output = invoke("run", *scenario, "--fmus", "build/native")
    assert code == 2
    assert "--native: build/native has no folder native" in output
    code, output = invoke(
        "sweep", *scenario, "--over", "amplifier.frequency=16,18", "--workers", "1", "--quiet"
    )
    assert code == 0, output


def test_the_monolith_comes_from_the_sibling_folder(
    python_parts: Path, native: Path, tmp_path: Path
) -> None:
    (tmp_path / "native").symlink_to(native)
    plan = load("oscillator-1", None, tmp_path / "native")
    with pytest.raises(FmuError, match="no such file"):
        monolithic(plan, tmp_path / "native")
    (tmp_path / "fmus").symlink_to(python_parts)
    single = monolithic(plan, tmp_path / "native")
    assert single.interfaces["monolith"].path == tmp_path / "fmus" / "monolith.fmu"
