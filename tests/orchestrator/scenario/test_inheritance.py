"""What a scenario takes from the one that it extends, and what it may leave."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run


def scenario(folder: Path, text: str, base: str = "oscillator-1") -> Path:
    path = folder / "mine.toml"
    path.write_text(f'extends = "{base}"\n{text}')
    return path


@pytest.mark.parametrize(
    ("variables", "recorded"),
    [('["payload.displacement"]', ["payload.displacement"]), ("[]", [])],
    ids=["replaced", "emptied"],
)
def test_the_record_is_replaced_or_emptied(
    variables: str, recorded: list[str], library: Path, tmp_path: Path
) -> None:
    text = f"[record]\ninherit = false\nvariables = {variables}\n"
    plan = load(scenario(tmp_path, text), library=library, time={"stop": "1 cycles"})
    assert [f"{name}.{variable.name}" for name, variable in plan.records] == recorded
    outcome = run(plan).checked()
    assert outcome.names == recorded
    assert outcome.rows.shape == (61, len(recorded))


def test_without_a_word_records_add(library: Path, tmp_path: Path) -> None:
    plan = load(scenario(tmp_path, '[record]\nvariables = ["spring.top.charge"]'), library=library)
    own = load("oscillator-1", library=library)
    assert len(plan.records) == len(own.records) + 1


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('[record]\ninherit = "no"', "record.inherit: expected true or false"),
        ("of_replaced = []", "of_replaced: unknown key"),
    ],
)
def test_a_bad_key_is_refused(text: str, reason: str, library: Path, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=reason):
        load(scenario(tmp_path, text), library=library)


def test_inherit_needs_something_to_inherit(library: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("[record]\ninherit = false\n")
    with pytest.raises(ScenarioError, match=r"record.inherit: has a meaning only beside extends"):
        load(path, library=library)


def test_records_of_a_part_that_was_replaced_are_dropped(library: Path, tmp_path: Path) -> None:
    """The film has a stress that the spring has not; with it goes the metric."""
    base = tmp_path / "base.toml"
    base.write_text(
        'extends = "oscillator-1"\n[components.spring]\nfmu = "membrane"\n'
        '[record]\nvariables = ["spring.top_hoop_stress"]\n'
        '[metrics]\nstress = "max(spring.top_hoop_stress)"\n'
    )
    other = '[components.spring]\nfmu = "spring"\n'
    plan = load(scenario(tmp_path, other, "base.toml"), library=library)
    assert plan.dropped == [
        "record spring.top_hoop_stress: not in the FMU in its place",
        "metric stress: spring.top_hoop_stress is not in the FMU in its place",
    ]
    assert "spring.force.value" in [f"{name}.{v.name}" for name, v in plan.records]


def test_own_records_of_a_replaced_part_have_to_be_there(library: Path, tmp_path: Path) -> None:
    text = '[components.spring]\nfmu = "membrane"\n[record]\nvariables = ["spring.fource.value"]\n'
    with pytest.raises(ScenarioError, match=r"did you mean 'spring.force.value'"):
        load(scenario(tmp_path, text), library=library)
