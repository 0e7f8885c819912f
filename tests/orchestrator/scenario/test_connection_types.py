"""Which types of variables can be connected or held."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.simulation.load import load
from tests.foreign.scenarios import Shelf, Value, last, ran
from tests.foreign.types import LARGEST, typed

pytestmark = pytest.mark.usefixtures("mark")


@pytest.mark.parametrize(
    ("version", "wire", "reason"),
    [
        (2, "a.out_real -> b.in_integer", "a real number does not pass into it without loss"),
        (2, "a.out_real -> b.in_boolean", "a real number does not pass into it without loss"),
        (2, "a.out_integer -> b.in_boolean", "only true and false pass into it"),
        (2, "a.out_integer -> b.in_enumeration", "only the same choices pass into it"),
        (2, "a.out_integer -> b.in_integer * 2.0", "gain and offset are for real numbers"),
        (2, "a.out_string -> b.in_real", "out_string is a String; only numbers can be wired"),
        (2, "a.out_real -> b.in_string", "in_string is a parameter: set it under components.b"),
        (3, "a.out_int64 -> b.in_int32", "does not fit without loss"),
        (3, "a.out_uint32 -> b.in_int32", "0 to 4294967295 does not fit without loss"),
        (3, "a.out_int8 -> b.in_uint64", "-128 to 127 does not fit without loss"),
        (3, "a.out_float32 -> b.in_int64", "a real number does not pass into it without loss"),
        (3, "a.out_enumeration -> b.in_boolean", "only true and false pass into it"),
        (3, "a.out_boolean -> b.in_boolean * 2.0", "gain and offset are for real numbers"),
        (3, "a.out_binary -> b.in_float64", "out_binary is a Binary; only numbers can be wired"),
        (3, "a.out_array -> b.in_array * 2.0", "not for whole ports"),
    ],
)
def test_lossy_wire_is_refused_at_load(
    version: int, wire: str, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError) as caught:
        load(typed(tmp_path, shelf("TYPES", version), version, wire))
    line = next(p for p in caught.value.problems if "wires[0]" in p)
    assert wire.partition(" * ")[0] in line
    assert reason in line


@pytest.mark.parametrize(
    ("version", "wire"),
    [
        (2, "a.out_boolean -> b.in_integer"),
        (2, "a.out_integer -> b.in_real * 0.5"),
        (2, "a.out_enumeration -> b.in_integer"),
        (3, "a.out_uint8 -> b.in_int16"),
        (3, "a.out_float32 -> b.in_float64"),
        (3, "a.out_int64 -> b.in_float64"),
    ],
)
def test_wire_into_a_wider_type_is_taken(
    version: int, wire: str, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = ran(typed(tmp_path, shelf("TYPES", version), version, wire))
    source, _, target = wire.partition(" * ")[0].partition(" -> ")
    gain = 0.5 if "*" in wire else 1.0
    passed = last(outcome)[target.replace("in_", "out_")]
    whole = "real" not in target and "float" not in target
    assert passed == gain * last(outcome)[source] + whole


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("int8", 128, "128.0 does not fit Int8, -128 to 127"),
        ("uint16", -1, "-1.0 does not fit UInt16, 0 to 65535"),
        ("int32", 0.5, "expected a whole number, got 0.5"),
        ("int64", LARGEST + 1, "does not fit Int64"),
        ("int64", LARGEST + 2, "does not fit Int64"),
        ("uint64", 2**64 - 1, "does not fit UInt64"),
        ("boolean", 1, "expected true or false, got 1.0"),
        ("enumeration", "fats", "'fats' is not a choice; did you mean 'fast'?"),
    ],
)
def test_held_value_that_its_type_does_not_take_is_refused(
    name: str, value: Value, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    path = typed(tmp_path, shelf("TYPES", 3), 3, held={f"a.in_{name}": value})
    with pytest.raises(ScenarioError) as caught:
        load(path)
    (line,) = caught.value.problems
    assert f"hold.a.in_{name}: " in line
    assert reason in line
