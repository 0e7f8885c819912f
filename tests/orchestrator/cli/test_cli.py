"""The command as a user sees it."""

from __future__ import annotations

import json
import subprocess
import tomllib
from pathlib import Path

import jsonschema
import pytest
import xarray
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.scenario.files import scenario_names, scenario_path
from orchestrator.simulation.load import unloaded
from tests.processes import python

runner = CliRunner()


def test_run_writes_result_plot_and_table(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "out" / "flap.nc"
    done = runner.invoke(
        app,
        ["run", "oscillator-1", "--output", str(target), "--fmus", str(library)],
    )
    assert done.exit_code == 0, done.output
    assert "travel" in done.output
    assert sorted(p.name for p in target.parent.iterdir()) == ["flap.nc", "flap.png"]
    with xarray.open_dataset(target) as data:
        assert "payload.displacement" in data


def test_set_changes_a_start_value(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "flap.nc"
    options = ["--fmus", str(library), "--no-picture", "--quiet", "--set", "payload.mass=3 g"]
    done = runner.invoke(app, ["run", "oscillator-1", "--output", str(target), *options])
    assert done.exit_code == 0, done.output
    assert done.output == ""
    with xarray.open_dataset(target) as data:
        assert "3 g" in data.attrs["scenario"]


def test_a_failed_run_leaves_a_partial_file_beside_an_earlier_result(
    library: Path, tmp_path: Path
) -> None:
    target = tmp_path / "flap.nc"
    target.write_text("an earlier result")
    options = ["--fmus", str(library), "--set", "payload.start_velocity=9000"]
    done = runner.invoke(app, ["run", "oscillator-1", "--output", str(target), *options])
    assert done.exit_code == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["flap.nc", "flap.partial.nc"]
    assert target.read_text() == "an earlier result"


def test_scenarios_are_listed() -> None:
    done = runner.invoke(app, ["scenarios"])
    assert done.exit_code == 0
    assert "flapping-full-wings" in done.output


def test_build_is_the_builder(tmp_path: Path) -> None:
    done = runner.invoke(app, ["build", "payload", "--into", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "payload.fmu").is_file()
    wrong = runner.invoke(app, ["build", "payloda", "--into", str(tmp_path)])
    assert wrong.exit_code == 2
    assert "did you mean 'payload'" in wrong.output


def test_help_is_light() -> None:
    """`run --help` loads neither plotting nor arrays nor FMU machinery."""
    heavy = ("matplotlib", "xarray", "numpy", "scipy", "fmpy", "pint", "control")
    code = (
        "import sys\n"
        "sys.argv = ['resilin', 'run', '--help']\n"
        "from orchestrator.cli import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        f"print([m for m in {heavy!r} if m in sys.modules], file=sys.stderr)\n"
    )
    done = subprocess.run(python("-c", code), capture_output=True, text=True, check=True)
    assert "Example:" in done.stdout
    assert done.stderr.strip() == "[]"


def test_inspect_shows_what_is_wired_and_held(library: Path) -> None:
    done = runner.invoke(app, ["inspect", "flapping-no-wing", "--fmus", str(library)])
    assert done.exit_code == 0, done.output
    for word in ("amplifier", "linkage.force", "linkage.load.torque", "0.000294"):
        assert word in done.output
    wrong = runner.invoke(app, ["inspect", "flapping-no-wings", "--fmus", str(library)])
    assert wrong.exit_code == 2
    assert "did you mean 'flapping-no-wing'" in wrong.output


def test_inspect_shows_names_whole_master_and_metrics(library: Path) -> None:
    command = ["inspect", "flapping-full-wings", "--fmus", str(library)]
    done = runner.invoke(app, command, env={"COLUMNS": "80"})
    plan = unloaded("flapping-full-wings", None, library)
    lines = [" ".join(line.split()) for line in done.output.replace("│", " ").splitlines()]
    assert "linkage.slider_mass 0.007145 kg" in lines and "…" not in done.output
    assert "gauss-seidel curvature amplifier, actuator, aero, linkage" in lines
    assert "travel peak_to_peak(linkage.displacement) in mm" in lines
    for name in plan.scenario.metrics.defined:
        assert any(line.startswith(f"{name} ") for line in lines), name


def test_a_metric_that_is_not_recorded_is_named_by_every_command(
    library: Path, tmp_path: Path
) -> None:
    scenario = tmp_path / "short.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[metrics]\ndriven = "mean(spring.force.value)"\n'
        '[record]\ninherit = false\nvariables = ["payload.displacement"]\n'
    )
    common = [str(scenario), "--fmus", str(library)]
    short = ["--stop", "4 cycles", "--output", str(tmp_path / "a.nc")]
    run = runner.invoke(app, ["run", *common, *short, "--html", str(tmp_path / "a.html")])
    (lost,) = [line for line in run.output.splitlines() if line.startswith("metrics left out: ")]
    assert run.exit_code == 0 and "driven" in lost and lost.endswith("resilin inspect says why")
    assert "Metrics left out" in (tmp_path / "a.html").read_text()
    sweep = ["sweep", *common, *short, "--over", "amplifier.frequency=10,20"]
    swept = runner.invoke(app, sweep).output
    assert "metric left out: driven: no point has a value" in " ".join(swept.split())
    shown = runner.invoke(app, ["inspect", *common], env={"COLUMNS": "200"}).output
    assert 'left out: not recorded; under [record] write variables = ["spring' in shown
    listed = runner.invoke(app, ["run", *common, *short, "--json"]).stdout
    assert "driven" in json.loads(listed)["metrics_left_out"]


def test_one_metric_that_is_left_out_has_its_remedy(library: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "one.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[metrics]\ndriven = "mean(spring.force.stiffness)"\n'
    )
    command = ["run", str(scenario), "--fmus", str(library), "--no-picture", "--stop", "4 cycles"]
    done = runner.invoke(app, [*command, "--output", str(tmp_path / "a.nc")])
    remedy = 'driven: not recorded; under [record] write variables = ["spring.force.stiffness"]'
    assert f"metric left out: {remedy}" in done.output.splitlines()


def test_a_run_names_its_master(library: Path, tmp_path: Path) -> None:
    command = ["run", "oscillator-1", "--fmus", str(library), "--no-picture", "--stop", "4 cycles"]
    options = ["--master", "jacobi", "--output", str(tmp_path / "a.nc")]
    done = runner.invoke(app, command + options)
    assert "communication steps by jacobi, " in done.output


def test_json_for_scripts(library: Path, tmp_path: Path) -> None:
    options = ["--fmus", str(library), "--stop", "4 cycles", "--step", "40 per cycle", "--json"]
    target = ["--output", str(tmp_path / "a.nc"), "--estimate"]
    done = runner.invoke(app, ["run", "oscillator-1", *options, *target])
    assert done.exit_code == 0, done.output
    facts = json.loads(done.stdout)
    assert facts["communication_steps"] == 160
    assert facts["metrics"]["travel"]["unit"] == "m"
    assert facts["estimated_relative_error"]["payload.displacement"] < 1e-2
    assert facts["coupling_energies"]["spring.force -> payload.force"]["exchanged"] > 0.0
    shown = runner.invoke(app, ["inspect", "oscillator-1", "--fmus", str(library), "--json"])
    assert json.loads(shown.stdout)["loops"] == [["amplifier", "spring", "payload"]]


def test_plot_draws_what_matches(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "a.nc"
    options = ["--fmus", str(library), "--quiet", "--no-picture", "--stop", "4 cycles"]
    runner.invoke(app, ["run", "oscillator-1", "--output", str(target), *options])
    done = runner.invoke(
        app, ["plot", str(target), "--variable", "*_energy", "--output", str(tmp_path / "e.svg")]
    )
    assert done.exit_code == 0, done.output
    assert (tmp_path / "e.svg").read_text().startswith("<?xml")
    wrong = runner.invoke(app, ["plot", str(target), "--variable", "payload.displacment"])
    assert wrong.exit_code == 2
    assert "did you mean 'payload.displacement'" in wrong.output
    (tmp_path / "file").write_text("")
    for bad, reason in (("e.docx", "name it *.png"), ("file/e.png", "cannot be made")):
        refused = runner.invoke(app, ["plot", str(target), "--output", str(tmp_path / bad)])
        assert refused.exit_code == 2, refused.output
        assert reason in refused.output
    assert runner.invoke(app, ["plot", str(tmp_path / "none.nc")]).exit_code == 2


def test_schema_accepts_every_shipped_scenario() -> None:
    """The schema is for editors, so every shipped scenario must fit it."""
    schema = json.loads(runner.invoke(app, ["schema"]).stdout)
    for name in scenario_names():
        tree = tomllib.loads(scenario_path(name).read_text(encoding="utf-8"))
        jsonschema.validate(tree, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"tiem": {}}, schema)


def test_warnings_are_shown(library: Path, tmp_path: Path) -> None:
    options = ["--fmus", str(library), "--no-picture", "--verbose"]
    options += ["--laws", "held", "--master", "gauss-seidel"]
    target = ["--output", str(tmp_path / "a.nc")]
    done = runner.invoke(app, ["run", "oscillator-1", *options, *target, "--stop", "10 cycles"])
    assert done.exit_code == 0, done.output
    assert "warning: spring.force -> payload.force creates" in done.output
    assert "rollbacks" in done.output


@pytest.mark.parametrize(
    "command",
    [
        "run",
        "sweep",
        "precision",
        "stability",
        "linearise",
        "calibrate",
        "paper",
        "inspect",
        "plot",
        "record",
        "recover",
        "schema",
    ],
)
def test_every_command_shows_an_example(command: str) -> None:
    done = runner.invoke(app, [command, "--help"])
    assert done.exit_code == 0
    assert f"resilin {command}" in done.output
