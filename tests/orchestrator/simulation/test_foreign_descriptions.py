"""FMUs whose descriptions are not by the book are read, said to be so, and run as they are."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.fmi.description import read_interface
from orchestrator.results.summary import warnings
from orchestrator.simulation.load import load
from tests.foreign.rewritten import rewritten
from tests.foreign.scenarios import (
    Shelf,
    each_version,
    hold,
    last,
    part,
    ran,
    scenario,
    wires,
)

GAIN = 'unit="1"'
EXPERIMENT = '<DefaultExperiment startTime="0.0" stepSize="0.01" />'
LAX: dict[str, tuple[tuple[tuple[str, str], ...], str]] = {
    "date": (((' variableNaming', ' generationDateAndTime="2017-02-13_16_10" variableNaming'),),
             "generationDateAndTime"),
    "undefined unit": (((GAIN, 'unit="Furz"'), ('<Unit name="1"', '<Unit name="other"')),
                       "unit 'Furz', which is not defined"),
    "empty unit": (((GAIN, 'unit=""'),), "an empty unit"),
    "unknown attribute": (((' variableNaming', ' canFly="true" variableNaming'),), "canFly"),
    "unknown element": (((EXPERIMENT, f"{EXPERIMENT}<Extra/>"),), "Extra"),
    "order": ((("</ModelStructure>", "</ModelStructure><LogCategories/>"),), "LogCategories"),
    "undefined type": (((GAIN, 'declaredType="Nothing"'),), "'Nothing', which is not defined"),
    "bounds": (((GAIN, 'unit="1" min="-INF" max="NaN"'),), "has max 'NaN'"),
    "model name": ((('modelName="GAIN"', ""),), "modelName"),
}  # fmt: skip


@each_version
@pytest.mark.parametrize("kind", LAX)
def test_what_changes_no_number_is_a_warning(
    kind: str, version: int, shelf: Shelf, tmp_path: Path
) -> None:
    changes, word = LAX[kind]
    fmu = rewritten(shelf("GAIN", version), tmp_path / "lax.fmu", *changes)
    texts = part("a", fmu, start={"gain": 3.0}, isolate=False), hold({"a.u": 2.0})
    outcome = ran(scenario(tmp_path, *texts))
    assert last(outcome)["a.y"] == 6.0
    found = [str(w) for w in warnings(outcome)]
    assert sum(word in text for text in found) == 1, found
    assert all("line " in text for text in found)
    path = scenario(tmp_path, *texts)
    path.write_text(f"strict = true\n{path.read_text()}")
    with pytest.raises(ScenarioError) as caught:
        load(path)
    assert word in str(caught.value)


@each_version
@pytest.mark.parametrize("name", ["a-b", "gain.1", "1a", "two words"])
def test_identifier_may_be_any_name_of_a_file(
    name: str, version: int, shelf: Shelf, tmp_path: Path
) -> None:
    change = ('modelIdentifier="gain"', f'modelIdentifier="{name}"')
    fmu = rewritten(shelf("GAIN", version), tmp_path / "own.fmu", change, library=name)
    outcome = ran(scenario(tmp_path, part("a", fmu), hold({"a.u": 2.0})))
    assert last(outcome)["a.y"] == 2.0
    assert f"'{name}' is not a C identifier" in read_interface(fmu).warnings[0]


@each_version
def test_comments_and_instructions_mean_nothing(version: int, shelf: Shelf, tmp_path: Path) -> None:
    marks = "<!-- a comment --><?an instruction?>"
    changes = [(f"<{n}>", f"<{n}>{marks}") for n in ("ModelVariables", "ModelStructure")]
    changes += [("</ModelVariables>", f"{marks}</ModelVariables>")]
    changes += [("<UnitDefinitions>", f"<UnitDefinitions>{marks}")]
    fmu = rewritten(shelf("GAIN", version), tmp_path / "lax.fmu", *changes)
    assert read_interface(fmu).warnings == ()
    assert set(read_interface(fmu).variables) >= {"u", "gain", "offset", "y"}


def test_a_structure_that_does_not_fit_leaves_dependencies_open(
    shelf: Shelf, tmp_path: Path
) -> None:
    fmu = rewritten(
        shelf("GAIN", 2), tmp_path / "lax.fmu", ('dependencies="1"', 'dependencies="9"')
    )
    interface = read_interface(fmu)
    assert interface.variables["y"].depends is None
    assert "ModelStructure names no variable '9'" in interface.warnings[0]


@each_version
def test_a_unit_without_a_definition_is_not_converted_unasked(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    bare = (('unit="N"', 'unit="kN"'), ('<Unit name="N"', '<Unit name="other"'))
    fmu = rewritten(shelf("PAIR", version), tmp_path / "lax.fmu", *bare)
    mass = shelf("MASS", version)
    texts = [part("a", fmu), part("b", mass)]
    holds = {f"a.{p}.{m}": 0.0 for p in ("first", "second") for m in ("displacement", "velocity")}
    path = scenario(tmp_path, *texts, wires("a.first.value -> b.force"), hold(holds))
    with pytest.raises(ScenarioError, match="does not define kN; give the wire a gain"):
        load(path)
    path = scenario(tmp_path, *texts, wires("a.first.value -> b.force * 1000.0"), hold(holds))
    (connection,) = load(path).connections
    assert connection.gain == 1000.0


@each_version
@pytest.mark.parametrize("isolate", [False, True])
def test_state_starts_where_the_scenario_says_and_files_are_found_beside_it(
    isolate: bool, version: int, shelf: Shelf, tmp_path: Path
) -> None:
    (tmp_path / "table.txt").write_text("42.5\n")
    start = {"x": 2.5, "k": 2.0, "table": "table.txt"}
    path = scenario(tmp_path, part("a", shelf("DECAY", version), start=start, isolate=isolate))
    outcome = ran(path)
    assert outcome.series("a.x")[0] == 2.5
    assert outcome.series("a.x")[-1] == pytest.approx(2.5 * math.exp(-0.2))
    assert last(outcome)["a.found"] == 42.5


def test_what_is_calculated_cannot_be_set_at_the_start(shelf: Shelf, tmp_path: Path) -> None:
    path = scenario(tmp_path, part("a", shelf("DECAY", 2), start={"found": 1.0}))
    with pytest.raises(ScenarioError, match="found: an output that is not of initial exact"):
        load(path)


@each_version
def test_stop_time_can_be_kept_from_an_eager_fmu(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    keys = {"start": {"eager": True}, "isolate": False}
    outcome = ran(scenario(tmp_path, part("a", shelf("DECAY", version), **keys), stop=0.2))
    assert outcome.series("a.x")[1] == pytest.approx(math.exp(-0.2))
    (warning,) = warnings(outcome)
    assert "stop_time = false" in str(warning)
    kept = part("a", shelf("DECAY", version), stop_time=False, **keys)
    outcome = ran(scenario(tmp_path, kept, stop=0.2))
    assert outcome.series("a.x")[1] == pytest.approx(math.exp(-0.01))
    assert list(warnings(outcome)) == []


@each_version
@pytest.mark.parametrize("isolate", [False, True])
def test_locals_and_parameters_are_recorded_when_named(
    isolate: bool, version: int, shelf: Shelf, tmp_path: Path
) -> None:
    record = '[record]\nvariables = ["a.x", "a.rate", "a.k"]'
    keys = {"start": {"k": 2.0}, "isolate": isolate}
    outcome = ran(scenario(tmp_path, part("a", shelf("DECAY", version), **keys), record))
    assert outcome.names == ["a.x", "a.k", "a.rate"]
    assert outcome.series("a.k").tolist() == [2.0] * 11
    assert outcome.series("a.rate") == pytest.approx(-2.0 * outcome.series("a.x"))


def test_an_fmu_of_locals_alone_is_recorded(shelf: Shelf, tmp_path: Path) -> None:
    fmu = rewritten(
        shelf("DECAY", 2), tmp_path / "lax.fmu",
        ('causality="output"', 'causality="local"'), ("<Outputs>", "<Outputs/><!--"),
        ("</Outputs>", "-->"),
    )  # fmt: skip
    assert ran(scenario(tmp_path, part("a", fmu))).names == ["a.x", "a.rate", "a.found"]


def test_declared_base_units_decide(shelf: Shelf, tmp_path: Path) -> None:
    """600 1/min, declared as 0.1047 rad/s, are 62.8 rad/s; 1 Nm is 1 N.m."""
    definition = '<BaseUnit s="-1" rad="1" factor="0.10471975511965977"/></Unit>'
    turns = rewritten(
        shelf("GAIN", 2), tmp_path / "turns.fmu", (GAIN, 'unit="1/min"'),
        ("<UnitDefinitions>", f'<UnitDefinitions><Unit name="1/min">{definition}'),
    )  # fmt: skip
    rate = '<Unit name="rad/s"><BaseUnit s="-1" rad="1"/></Unit>'
    rads = rewritten(
        shelf("GAIN", 3), tmp_path / "rads.fmu", (GAIN, 'unit="rad/s"'),
        ("<UnitDefinitions>", f"<UnitDefinitions>{rate}"),
    )  # fmt: skip
    texts = part("a", turns), part("b", rads), wires("a.y -> b.u"), hold({"a.u": 600.0})
    assert last(ran(scenario(tmp_path, *texts)))["b.y"] == pytest.approx(20.0 * math.pi)
    frequency = '<Unit name="Hz"><BaseUnit s="-1"/></Unit>'
    hertz = rewritten(
        shelf("GAIN", 2), tmp_path / "hertz.fmu", (GAIN, 'unit="Hz"'),
        ("<UnitDefinitions>", f"<UnitDefinitions>{frequency}"),
    )  # fmt: skip
    texts = part("a", hertz), part("b", rads), wires("a.y -> b.u"), hold({"a.u": 1.0})
    with pytest.raises(ScenarioError, match="Hz is not convertible to rad/s"):
        load(scenario(tmp_path, *texts))
