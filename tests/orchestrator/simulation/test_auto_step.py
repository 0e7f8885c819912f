"""Steps and masters of scenarios that leave them open."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import ScenarioError
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.reference.solution import reference_solution
from tests.evals.two_masses import scenarios
from tests.foreign.build import foreign

AUTO = {"step": "auto", "stop": "10 cycles"}


@pytest.mark.parametrize("scenario", ["oscillator-1", "flapping-no-wing", "flapping-full-wings"])
def test_the_step_that_is_found_keeps_its_promise(library: Path, scenario: str) -> None:
    """The whole run's true error is below 1e-3, and at twice the step it would not be far off."""
    plan = load(scenario, None, library, time=AUTO)
    assert "spectral radius 0." in plan.advice
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


def test_no_step_will_do(library: Path, tmp_path: Path) -> None:
    """A unit that drops out in the trial stops the search with its reason."""
    scenario = tmp_path / "faulty.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[time]\nstep = "auto"\n'
        '[[faults]]\nat = "1 cycle"\non = "spring"\nkind = "drop"\n'
    )
    with pytest.raises(ScenarioError, match=r"time.step: none is found; .*dropped out"):
        load(scenario, None, library)


def test_units_of_one_step_size_need_a_step(library: Path, tmp_path: Path) -> None:
    folder = scenarios(tmp_path)
    foreign("MASS", folder, variable_step=False)
    with pytest.raises(ScenarioError, match=r"first, second takes steps of one size only; give it"):
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


def test_the_command_says_what_it_found(library: Path, tmp_path: Path) -> None:
    options = ["--fmus", str(library), "--output", str(tmp_path / "r.nc"), "--no-picture"]
    given = ["--step", "auto", "--stop", "4 cycles"]
    done = CliRunner().invoke(app, ["run", "oscillator-1", *given, *options])
    assert done.exit_code == 0, done.output
    assert "auto: step 0.000" in done.output
