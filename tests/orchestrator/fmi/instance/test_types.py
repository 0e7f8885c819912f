"""Values of every type of FMI 2.0 and 3.0, into an instance and out of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import InitialisationError, SimulationError
from orchestrator.simulation.load import load
from tests.foreign.scenarios import (
    Shelf,
    Value,
    each_version,
    hold,
    last,
    part,
    ran,
    scenario,
    wires,
)
from tests.foreign.types import LARGEST, as_held, echoed, typed

pytestmark = pytest.mark.usefixtures("mark")


@pytest.mark.parametrize("end", [0, 1], ids=["least", "greatest"])
@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_every_type_travels_exactly(
    version: int, isolate: bool, end: int, shelf: Shelf, tmp_path: Path
) -> None:
    types = shelf("TYPES", version)
    known = echoed(version, end)
    held = {f"a.in_{name}": as_held(name, value[0]) for name, value in known.items()}
    joined = [f"a.out_{name} -> b.in_{name}" for name in known]
    if version == 3:
        held |= {f"a.in_array[{k}]": 0.5 * k for k in (1, 2, 3)}
        joined.append("a.out_array -> b.in_array")
    parts = [part(name, types, isolate=isolate) for name in "ab"]
    values = last(ran(scenario(tmp_path, *parts, wires(*joined), hold(held), stop=0.03)))
    for name, (_, first, second) in known.items():
        for kind in ("out", "late"):
            assert values[f"a.{kind}_{name}"] == first, name
            assert values[f"b.{kind}_{name}"] == second, name
    if version == 3:
        assert [values[f"b.out_array[{k}]"] for k in (1, 2, 3)] == [2.0, 4.0, 6.0]


def test_elements_of_arrays_are_wired_one_by_one(shelf: Shelf, tmp_path: Path) -> None:
    fmu = shelf("TYPES", 3)
    crossed = ("a.out_array[2] -> b.in_array[1]", "a.out_array[1] -> b.in_array[3] * -1.5")
    held = {"a.in_array[1]": 10.0, "a.in_array[2]": 20.0, "b.in_array[2]": 7.0}
    values = last(ran(typed(tmp_path, fmu, 3, *crossed, held=held)))
    assert [values[f"b.out_array[{k}]"] for k in (1, 2, 3)] == [80.0, 14.0, -60.0]


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
def test_elements_that_nothing_feeds_keep_their_start(
    isolate: bool, shelf: Shelf, tmp_path: Path
) -> None:
    names = {f"a.in_{name}": as_held(name, 1.0) for name in echoed(3, 0)}
    component = part("a", shelf("TYPES", 3), isolate=isolate, start={"in_array[3]": 7.0})
    held = hold({**names, "a.in_array[1]": 5.0})
    values = last(ran(scenario(tmp_path, component, held, stop=0.02)))
    assert [values[f"a.out_array[{k}]"] for k in (1, 2, 3)] == [10.0, 0.0, 14.0]


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
def test_matrix_is_a_parameter_by_element(isolate: bool, shelf: Shelf, tmp_path: Path) -> None:
    names = {f"a.in_{name}": as_held(name, 1.0) for name in echoed(3, 0)}
    start: dict[str, Value] = {"in_matrix[1,2]": 5.0, "in_matrix[2,2]": -1.0}
    component = part("a", shelf("TYPES", 3), isolate=isolate, start=start)
    held = hold({**names, "a.in_array[1]": 0.0})
    values = last(ran(scenario(tmp_path, component, held, stop=0.02)))
    transposed = [values[f"a.out_matrix[{i},{j}]"] for i in (1, 2) for j in (1, 2)]
    assert transposed == [1.0, 3.0, 5.0, -1.0]


@each_version
def test_text_is_a_parameter(version: int, shelf: Shelf, tmp_path: Path) -> None:
    """The FMU takes 61 bytes and no more."""
    for text, taken in (("Flügelschlag", True), ("ü" * 30 + "x", True), ("ü" * 31, False)):
        fmu = shelf("TYPES", version)
        path = typed(tmp_path, fmu, version, start={"in_string": text}, isolate=True)
        if taken:
            ran(path)
            continue
        with pytest.raises(InitialisationError, match=r"a: fmi\dSetString: error: not a text"):
            ran(path)


@each_version
def test_choices_and_truths_start_by_name(version: int, shelf: Shelf, tmp_path: Path) -> None:
    fmu = shelf("TYPES", version)
    start: dict[str, Value] = {"in_boolean": True, "in_enumeration": "fast"}
    plan = load(typed(tmp_path, fmu, version, start=start))
    assert plan.starts["a"] == {"in_boolean": 1.0, "in_enumeration": 2.0}


@pytest.mark.parametrize("kind", ["Int64", "UInt64"])
def test_whole_number_beyond_doubles_ends_the_run(kind: str, shelf: Shelf, tmp_path: Path) -> None:
    path = typed(tmp_path, shelf("TYPES", 3), 3, held={f"a.in_{kind.lower()}": LARGEST})
    with pytest.raises(SimulationError, match=rf"a: an output of type {kind} is beyond 2\^53"):
        ran(path)
