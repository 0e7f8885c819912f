"""Automatic steps and masters of scenarios that leave them open."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import build_fmus
from orchestrator.cli import app
from orchestrator.errors import ScenarioError
from orchestrator.recording.recording import open_recording
from orchestrator.results.outcome import Outcome
from orchestrator.scenario.component_options import component_of
from orchestrator.scenario.parse import load_scenario
from orchestrator.scenario.plan import Plan
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.reference.solution import reference_solution
from tests.evals.two_masses import scenarios
from tests.foreign.build import foreign

AUTO = {"step": "auto", "stop": "10 cycles"}


@pytest.mark.parametrize(
    "scenario",
    [
        "oscillator-1",
        pytest.param("flapping-spring-full-wings", marks=pytest.mark.slow),
        pytest.param("flapping-no-wing", marks=pytest.mark.slow),
        pytest.param("flapping-full-wings", marks=pytest.mark.slow),
    ],
)
def test_the_automatic_step_is_accurate(library: Path, scenario: str) -> None:
    """The true error of the whole run is below 1e-3."""
    plan = load(scenario, None, library, time=AUTO)
    assert "spectral radius 0." in plan.step_reason
    assert plan.scenario.time.step == plan.grid.step
    done = run(plan)
    errors, _ = reference_solution(plan, library).errors(done)
    assert max(errors[name] for name in plan.leading) < 1e-3


def test_a_stiff_coupling_gets_a_finer_step(library: Path, tmp_path: Path) -> None:
    folder = scenarios(tmp_path)
    time = {"step": "auto", "stop": 10.0}
    soft, stiff = (
        load(folder / "numbers.toml", {"pair.stiffness": k}, library, time=time).grid.step
        for k in ("1", "100")
    )
    assert 4.0 * stiff < soft < 0.2


def test_no_step_is_found(library: Path, tmp_path: Path) -> None:
    """An instance that drops out in the trial stops the search with its reason."""
    scenario = tmp_path / "faulty.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[time]\nstep = "auto"\n'
        '[[faults]]\nat = "1 cycle"\non = "spring"\nkind = "drop"\n'
    )
    with pytest.raises(ScenarioError, match=r"time.step: no step is found; .*dropped out"):
        load(scenario, None, library)


def test_a_recording_is_not_read_past_the_end_of_the_run(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It ends with the run: trials stay within, and in the step map it is a drive at rest."""
    tried: list[float] = []

    def noted(plan: Plan, **options: Any) -> Outcome:
        tried.append(plan.grid.stop)
        return run(plan, **options)

    monkeypatch.setattr("orchestrator.simulation.auto_step.run", noted)
    t = np.linspace(0.0, 1.06 / 50.0, 213)
    top = 1000.0 * (np.sin(2.0 * np.pi * 50.0 * t) >= 0.0)
    head = "time [s],top.voltage [V],bottom.voltage [V]"
    np.savetxt(
        tmp_path / "scope.csv", np.column_stack([t, top, 1000.0 - top]), "%.12g", ",",
        header=head, comments="",
    )  # fmt: skip
    scenario = tmp_path / "mine.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[components.amplifier]\ndata = "scope.csv"\n'
        '[time]\nstep = "auto"\nfrequency = "50 Hz"\nstop = "1.06 cycles"\n'
    )
    plan = load(scenario, None, library)
    assert "spectral radius 0." in plan.step_reason
    assert max(tried) <= plan.grid.stop
    recording = component_of(tmp_path / "scope.csv", "scope", {})
    build_fmus.build(
        "replay", alias="scope", recording=open_recording(recording, scenario), into=tmp_path
    )
    scenario.write_text(scenario.read_text().replace('data = "scope.csv"', 'fmu = "./scope.fmu"'))
    assert load(scenario, None, library).grid.step == plan.grid.step, "the same as an FMU"


def test_instances_of_one_step_size_need_a_step(library: Path, tmp_path: Path) -> None:
    folder = scenarios(tmp_path)
    foreign("MASS", folder, variable_step=False)
    reason = "first, second can only take steps of one size; give that size"
    with pytest.raises(ScenarioError, match=reason):
        load(folder / "numbers.toml", None, library, time={"step": "auto"})


def test_the_master_follows_from_the_wires(library: Path, tmp_path: Path) -> None:
    """Laws or no feedback: Gauss-Seidel. Bare numbers both ways: extrapolated."""
    assert load("oscillator-1", None, library).scenario.master.kind == "gauss-seidel"
    blocked = load("blocked-force", None, library, master={"laws": "held"})
    assert blocked.scenario.master.kind == "extrapolated"
    held = load("oscillator-1", None, library, master={"laws": "held"})
    assert held.scenario.master.kind == "extrapolated"
    numbers = load(scenarios(tmp_path) / "numbers.toml", None, library, master={"kind": "auto"})
    assert numbers.scenario.master.kind == "extrapolated"


def test_the_command_reports_the_step(library: Path, tmp_path: Path) -> None:
    options = ["--fmus", str(library), "--output", str(tmp_path / "r.nc"), "--no-picture"]
    given = ["run", "oscillator-1", "--step", "auto", "--stop", "4 cycles", *options]
    done = CliRunner().invoke(app, given)
    assert done.exit_code == 0, done.output
    assert "auto: step 0.000" in done.output
    done = CliRunner().invoke(app, [*given, "--json"])
    assert done.exit_code == 0, done.output
    facts = json.loads(done.stdout)
    assert facts["step_reason"].startswith("step 0.000")
    assert facts["advice"] == facts["step_reason"]


def test_what_only_describes_a_scenario_loads_no_fmu(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not for an automatic step either, which a run finds by trials."""

    def loaded(*arguments: object, **options: object) -> None:
        raise AssertionError("an FMU was loaded")

    monkeypatch.setattr("orchestrator.simulation.system.open_instance", loaded)
    monkeypatch.chdir(tmp_path)
    Path("own.toml").write_text('extends = "oscillator-1"\n[time]\nstep = "auto"\n')
    runner = CliRunner()
    shown = runner.invoke(app, ["inspect", "own.toml", "--json", "--fmus", str(library)])
    assert json.loads(shown.stdout)["time"]["step"] == "auto"
    written = runner.invoke(app, ["inspect", "own.toml", "--fmus", str(library)])
    assert "a run chooses" in written.stdout
    made = runner.invoke(app, ["export", "own.toml", "--fmus", str(library), "--output", "own.ssp"])
    assert (made.exit_code, 'step = "auto"' in made.stdout) == (0, True)
    assert load_scenario("own.ssp")[0].time.step == "auto"
