"""Scenarios as SSP archives: valid by the standard's schemas, the same when they come back."""

from __future__ import annotations

import functools
import re
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import RenamedWarning
from orchestrator.scenario.files import scenario_names
from orchestrator.scenario.plan import Plan
from orchestrator.scenario.ssp.read import KEYS
from orchestrator.scenario.ssp.write import VERSIONS, Package, write_ssp
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

runner = CliRunner()


@pytest.fixture(autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))


def exported(native: Path, *arguments: str) -> str:
    done = runner.invoke(app, ["export", *arguments, "--fmus", str(native)])
    assert done.exit_code == 0, done.stderr
    return done.stdout


@functools.cache
def schema(name: str, version: str) -> Any:
    """A schema of the standard, as pyssp-standard brings it."""
    import pyssp_standard

    folder = Path(pyssp_standard.__file__).parent / "resources"
    folder = folder / "ssp2" if version == "2.0" else folder
    return etree.XMLSchema(file=str(folder / f"SystemStructure{name}.xsd"))


def assert_valid(name: str, version: str, root: Any) -> None:
    found = schema(name, version)
    assert found.validate(root), found.error_log


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("scenario", scenario_names())
def test_every_scenario_is_valid_ssp(
    native: Path, tmp_path: Path, scenario: str, version: str
) -> None:
    path = tmp_path / "a.ssp"
    write_ssp(Package(load(scenario, None, native), {}, version=version), path)
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
        values = etree.fromstring(archive.read("resources/parameters.ssv"))
    assert_valid("Description", version, root)
    assert_valid("ParameterValues", version, values)
    spaces = {"ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues"}
    inside = root.findall(".//ssv:ParameterSet", spaces)
    assert inside
    for each in inside:
        assert_valid("ParameterValues", version, etree.fromstring(etree.tostring(each)))


def recorded(plan: Plan) -> set[str]:
    return {f"{component}.{variable.name}" for component, variable in plan.records}


@pytest.mark.parametrize("scenario", scenario_names())
def test_every_scenario_comes_back_as_it_was(native: Path, tmp_path: Path, scenario: str) -> None:
    """Wires, starts, holds, records, order, grid: what a run is made of."""
    plan = load(scenario, None, native)
    write_ssp(Package(plan, {}), tmp_path / "a.ssp")
    back = load(str(tmp_path / "a.ssp"))

    def wires(p: Any) -> set[tuple[str, str, str, str, float, float]]:
        return {
            (c.source, c.output.name, c.target, c.input.name, c.gain, c.offset)
            for c in p.connections
        }

    assert wires(back) == wires(plan)
    assert back.order == plan.order
    assert back.grid == plan.grid
    assert back.frequency == plan.frequency
    assert back.scenario.master.kind == plan.scenario.master.kind
    assert recorded(back) == recorded(plan)
    for name, interface in plan.interfaces.items():
        for v in interface.of("parameter", "input"):
            key = f"{name}.{v.name}"
            mine = plan.held.get(key, plan.starts[name].get(v.name, v.start))
            assert back.held.get(key, back.starts[name].get(v.name, v.start)) == mine, key


@pytest.mark.parametrize("scenario", ["flapping-full-wings", "oscillator-1"])
def test_an_exported_scenario_runs_to_the_same_bits(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scenario: str
) -> None:
    monkeypatch.chdir(tmp_path)
    exported(native, scenario, "--output", "a.ssp", "--stop", "10 cycles")
    one = run(load(scenario, None, native, time={"stop": "10 cycles"}))
    other = run(load("a.ssp"))
    assert sorted(one.names) == sorted(other.names)
    for name in one.names:
        assert np.array_equal(one.series(name), other.series(name)), name


def test_choices_are_built_in_and_further_sets_go_along(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other tools do not read enumerations from SSP: the part starts with its choice instead."""
    monkeypatch.chdir(tmp_path)
    printed = exported(
        native, "oscillator-1", "--parameter-set", "heavy:payload.mass=2 g", "--parameter-set",
        "heavy:spring.damping=0.1 N*s/m", "--parameter-set", "slow:amplifier.frequency=20 Hz",
    )  # fmt: skip
    assert "3 components" in printed
    with zipfile.ZipFile("oscillator-1.ssp") as archive:
        names = archive.namelist()
        assert "resources/amplifier_raised_sine.fmu" in names
        assert b"Enumeration" not in archive.read("SystemStructure.ssd")
    plan = load("oscillator-1.ssp:heavy")
    assert plan.starts["payload"]["mass"] == pytest.approx(2e-3)
    assert plan.starts["spring"]["damping"] == pytest.approx(0.1)
    assert load("oscillator-1.ssp:slow").frequency == 20.0
    assert load("oscillator-1.ssp").interfaces["amplifier"].variables["waveform"].start == 3.0


def test_a_recording_goes_along_as_an_fmu(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["record", "oscillator-1", "--part", "amplifier", "--stop", "4 cycles"]
    done = runner.invoke(app, [*command, "--output", "amp.csv", "--fmus", str(native)])
    assert done.exit_code == 0, done.stderr
    Path("r.toml").write_text(
        'extends = "oscillator-1"\n[time]\nstop = "4 cycles"\n[components.amplifier]\n'
        'data = "amp.csv"\n'
    )
    exported(native, "r.toml", "--output", "r.ssp")
    one, other = run(load("r.toml", None, native)), run(load("r.ssp"))
    name = "payload.displacement"
    assert other.series(name) == pytest.approx(one.series(name), abs=1e-12)


def test_actions_and_faults_come_back_and_are_remarked(native: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "s.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[[actions]]\nat = "10 ms"\n'
        'set = { "amplifier.amplitude" = "1 kV" }\n'
        '[[faults]]\nat = "20 ms"\non = "spring"\nkind = "freeze"\n'
    )
    plan = load(scenario, None, native)
    remarks = write_ssp(Package(plan, {}), tmp_path / "a.ssp")
    assert any("1 timed actions" in line for line in remarks)
    assert any("1 injected faults" in line for line in remarks)
    assert any("enumerations" in line for line in remarks)
    back = load(str(tmp_path / "a.ssp"))
    assert back.actions == plan.actions
    assert back.faults == plan.faults


def test_an_archive_of_the_previous_release_is_read(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its annotation is of type org.resilin.scene: read the same, with a warning."""
    plan = load("oscillator-1", None, native)
    write_ssp(Package(plan, {}), tmp_path / "new.ssp")
    with (
        zipfile.ZipFile(tmp_path / "new.ssp") as new,
        zipfile.ZipFile(tmp_path / "old.ssp", "w") as old,
    ):
        for name in new.namelist():
            content = new.read(name)
            if name == "SystemStructure.ssd":
                content = content.replace(b"org.resilin.scenario", b"org.resilin.scene")
                content = content.replace(b"resilin:scenario", b"resilin:scene")
                assert content.count(b"org.resilin.scene") == 2
            old.writestr(name, content)
    monkeypatch.chdir(tmp_path)
    with pytest.warns(RenamedWarning, match=r"old\.ssp: .* now called org\.resilin\.scenario"):
        back = load("old.ssp")
    today = load("new.ssp")
    for key in (*KEYS, "title", "wires", "hold"):
        assert getattr(back.scenario, key) == getattr(today.scenario, key), key
    assert (back.grid, back.starts) == (plan.grid, today.starts)
    assert back.scenario.metrics.defined


def test_another_tool_finds_no_fault_with_the_connections(native: Path, tmp_path: Path) -> None:
    from pyssp_standard.ssp import SSP

    path = tmp_path / "a.ssp"
    write_ssp(Package(load("flapping-full-wings", None, native), {}), path)
    with SSP(path, mode="r") as archive, archive.system_structure as ssd:
        faults = ssd.check_connections()
        assert len(ssd.connections()) == 50
        assert not faults


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("oscillator-1", "--output", "a.zip"), "name it *.ssp"),
        (("oscillator-1", "--ssp", "3.0"), "3.0: is not written"),
        (("oscilator-1",), "did you mean 'oscillator-1'"),
        (("oscillator-1", "--parameter-set", "heavy"), "write NAME:component.parameter=value"),
        (("oscillator-1", "--parameter-set", "a b:payload.mass=1"), "write NAME:component"),
        (("oscillator-1", "--parameter-set", "parameters:payload.mass=1"), "write NAME:component"),
        (("oscillator-1", "--parameter-set", "heavy:payload.mas=1"), "did you mean 'mass'"),
        (("oscillator-1", "--parameter-set", "heavy:payload.mass=1 m"), "quantity in kg"),
        (("oscillator-1", "--set", "payload.mas=1"), "did you mean 'mass'"),
        (("oscillator-1", "--output", "file/a.ssp"), "cannot be made"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...],
    message: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("x")
    done = runner.invoke(app, ["export", *arguments, "--fmus", str(native)])
    assert done.exit_code == 2
    assert re.search(re.escape(message), done.stderr), done.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file"]
