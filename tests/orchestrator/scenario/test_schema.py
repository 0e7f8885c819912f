"""The scenario language: inheritance, overrides, and all problems at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.scenario.files import scenario_names
from orchestrator.scenario.parse import load_scenario
from orchestrator.simulation.load import load


@pytest.mark.parametrize("name", scenario_names())
def test_every_shipped_scenario_is_well_formed(name: str) -> None:
    scenario, _ = load_scenario(name)
    assert scenario.title
    assert scenario.components


def test_full_wings_differ_from_no_wing_only_as_written() -> None:
    bare, _ = load_scenario("flapping-no-wing")
    full, _ = load_scenario("flapping-full-wings")
    assert set(full.components) - set(bare.components) == {"aero"}
    assert "linkage.load.torque" in bare.hold
    assert "linkage.load.torque" not in full.hold
    assert full.components["amplifier"].start["waveform"] == "square"


def test_without_drops_wires_holds_and_records(tmp_path: Path) -> None:
    scenario = tmp_path / "bare.toml"
    scenario.write_text(
        'extends = "flapping-full-wings"\nwithout = ["aero"]\n'
        '[hold]\n"linkage.load.torque" = 0\n'
        '[master]\norder = ["amplifier", "actuator", "linkage"]\n'
    )
    scenario, _ = load_scenario(scenario)
    assert "aero" not in scenario.components
    assert not [w for w in scenario.wires if "aero" in w.source + w.target]
    assert not [v for v in scenario.record.variables if v.startswith("aero")]


def test_a_component_with_another_part_starts_afresh(library: Path, tmp_path: Path) -> None:
    """The film has a loss factor too, and means another one by it."""
    path = tmp_path / "swap.toml"
    path.write_text('extends = "oscillator-1"\n[components.spring]\nfmu = "membrane"\n')
    plan = load(path, None, library)
    assert plan.starts["spring"] == {}
    assert plan.dropped[0].startswith("spring starts afresh: membrane has other parameters")
    text = path.read_text() + "start = { loss_factor = 0.2 }\n"
    path.write_text(text)
    assert load(path, None, library).starts["spring"] == {"loss_factor": 0.2}
    changed = load(path, {"spring.loss_factor": "0.3"}, library)
    assert changed.starts["spring"] == {"loss_factor": 0.3}
    above = tmp_path / "above.toml"
    above.write_text('extends = "swap.toml"\n[components.spring.start]\nloss_frequency = "40 Hz"\n')
    assert load(above, None, library).starts["spring"] == {
        "loss_factor": 0.2,
        "loss_frequency": 40.0,
    }


def test_a_part_built_otherwise_keeps_the_start_values(library: Path, tmp_path: Path) -> None:
    """A variant of the same part takes all of them: they stay, and nothing is dropped."""
    (tmp_path / "spring_tight.fmu").write_bytes((library / "spring.fmu").read_bytes())
    path = tmp_path / "swap.toml"
    path.write_text(
        'extends = "oscillator-1"\n[components.spring]\nfmu = "./spring_tight.fmu"\n'
        "start = { damping = 0.5 }\n"
    )
    plan = load(path, None, library)
    before = load("oscillator-1", None, library).starts["spring"]
    assert plan.starts["spring"] == {**before, "damping": 0.5}
    assert plan.dropped == []


def test_all_problems_come_at_once(tmp_path: Path) -> None:
    scenario = tmp_path / "bad.toml"
    scenario.write_text("titel = 'x'\n[time]\nstop = true\n[components.a]\nfmu = 'a'\nstrat = {}\n")
    with pytest.raises(ScenarioError) as caught:
        load_scenario(scenario)
    text = str(caught.value)
    assert "did you mean 'title'" in text
    assert "did you mean 'start'" in text
    assert "time.stop" in text


def test_overrides_from_the_command_line() -> None:
    scenario, _ = load_scenario("oscillator-2", {"payload.mass": "3 g"}, master={"laws": "held"})
    assert scenario.components["payload"].start["mass"] == "3 g"
    assert scenario.master.laws == "held"
    with pytest.raises(ScenarioError, match="did you mean 'payload'"):
        load_scenario("oscillator-2", {"paylod.mass": "3 g"})


def test_an_fmu_by_path_is_found_beside_the_scenario_that_names_it(
    library: Path, tmp_path: Path
) -> None:
    """Also where a scenario in another folder extends that one."""
    inner = tmp_path / "inner"
    inner.mkdir()
    (inner / "mine.fmu").write_bytes((library / "payload.fmu").read_bytes())
    (inner / "base.toml").write_text(
        'extends = "oscillator-1"\n[components.payload]\nfmu = "./mine.fmu"\n'
    )
    top = tmp_path / "top.toml"
    top.write_text('extends = "inner/base.toml"\n[time]\nstop = "2 cycles"\n')
    assert load(top, None, library).interfaces["payload"].path.samefile(inner / "mine.fmu")
