"""Foreign FMUs in scenarios: coupled, typed, in loops, isolated; and what becomes of sick ones."""

from __future__ import annotations

import errno
import functools
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import uuid
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import fmpy
import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.errors import FmuError, InitialisationError, ScenarioError, SimulationError
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance import Instance, Limits, open_instance
from orchestrator.fmi.instance.base import MOST_MESSAGES
from orchestrator.fmi.instance.protocol import ANSWER, Garbled, read_answer
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.system import System
from tests.foreign.build import foreign

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")

VERSIONS = (2, 3)
HOST = b"orchestrator.fmi.instance.isolated_child"
MARK = "RESILIN_TEST_MARK"
COMMAND = [sys.executable, "-m", "orchestrator.cli", "run"]
LARGEST = 2**53 - 1
"""Greatest whole number that no other one rounds to as a double."""
RANGES = {
    "integer": (-(2**31), 2**31 - 1),
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32)},
    "int64": (-LARGEST, LARGEST),
    "uint64": (0, LARGEST),
}
REALS = {"real": (0.1, -9.87e99), "float64": (0.1, -9.87e99)}
REALS["float32"] = (float(np.float32(0.1)), float(np.float32(3.4e38)))

each_version = pytest.mark.parametrize("version", VERSIONS)
Value = float | str | bool
Shelf = Callable[..., Path]


@pytest.fixture(scope="module")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Shelf:
    """A foreign FMU, `shelf(model, version, **options)`, built where it is not there yet."""

    @functools.cache
    def take(model: str, version: int, **options: object) -> Path:
        return foreign(model, tmp_path_factory.mktemp(model), version=version, **options)  # type: ignore[arg-type]

    return take


@pytest.fixture(autouse=True)
def mark(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """What all processes of a test carry in their environment: none is left, and no folder."""
    word = uuid.uuid4().hex
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv(MARK, word)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    yield word
    assert marked(word) == []
    assert hosts() == []
    assert list(temporary.iterdir()) == []


def looked_at(name: str) -> Iterator[tuple[int, bytes]]:
    """One file of /proc for each process that may be read."""
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                yield int(folder.name), (folder / name).read_bytes()
            except OSError:
                continue


def marked(word: str) -> list[int]:
    """Processes other than this one with a mark in their environment."""
    wanted = f"{MARK}={word}".encode()
    return [pid for pid, text in looked_at("environ") if wanted in text and pid != os.getpid()]


def hosts(parent: int | None = None) -> list[int]:
    """Processes of isolated units below a process, this one by default; dead ones included."""
    ours = str(parent or os.getpid()).encode()
    stats = {pid: text.rpartition(b")")[2].split() for pid, text in looked_at("stat")}
    lines = dict(looked_at("cmdline"))
    return [
        pid
        for pid, (state, above, *_) in stats.items()
        if above == ours and (HOST in lines.get(pid, b"") or state == b"Z")
    ]


def awaited(condition: Callable[[], bool], seconds: float) -> bool:
    """Whether something comes true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def toml(value: Value | Path | Mapping[str, Value]) -> str:
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{json.dumps(k)} = {toml(v)}' for k, v in value.items())} }}"
    if isinstance(value, str | Path):
        return json.dumps(str(value), ensure_ascii=False)
    return str(value).lower() if isinstance(value, bool) else repr(value)


def part(name: str, fmu: Path | str, **keys: Value | Mapping[str, Value]) -> str:
    """A component of a scenario."""
    lines = [f"{key} = {toml(value)}" for key, value in {"fmu": fmu, **keys}.items()]
    return "\n".join([f"[components.{name}]", *lines])


def wires(*texts: str) -> str:
    """Wires of a scenario, each written as `a.y -> b.u`, or as `a.y -> b.u * 2.0`."""
    lines = []
    for text in texts:
        ends, _, gain = text.partition(" * ")
        source, _, target = ends.partition(" -> ")
        lines += ["[[wires]]", f"from = {toml(source)}", f"to = {toml(target)}"]
        lines += [f"gain = {gain}"] if gain else []
    return "\n".join(lines)


def hold(values: Mapping[str, Value]) -> str:
    """Holds of a scenario."""
    return "\n".join(["[hold]", *(f"{toml(k)} = {toml(v)}" for k, v in values.items())])


def scenario(
    folder: Path, *texts: str, stop: float = 0.1, step: float = 0.01, more: str = ""
) -> Path:
    """A scenario file of components, wires and holds."""
    times = f"[time]\nstop = {stop!r}\nstep = {step!r}\n{more}"
    path = folder / "scenario.toml"
    path.write_text("\n".join([times, *texts]))
    return path


def ran(path: Path, **options: object) -> Outcome:
    outcome = run(load(path, **options))  # type: ignore[arg-type]
    if outcome.failure is not None:
        raise outcome.failure
    return outcome


def last(outcome: Outcome) -> dict[str, float]:
    """Values at the end of a run, by name."""
    return dict(zip(outcome.names, outcome.rows[-1].tolist(), strict=True))


# ------------------------------------------------------------------------------------- coupling


def masses(
    folder: Path,
    shelf: Shelf,
    versions: tuple[int, int] = (2, 2),
    *,
    master: str = "interface-newton",
    more: str = "",
    isolate: bool | None = None,
    rollback: bool = True,
    stop: float = 1.5,
) -> Path:
    """Two unit masses on springs of 3 N/m to the ground, and one of 2 N/m between them."""
    mass = shelf("MASS", versions[0], rollback=rollback)
    pair = shelf("PAIR", versions[1], rollback=rollback)
    keys = {} if isolate is None else {"isolate": isolate}
    return scenario(
        folder,
        f'[master]\nkind = "{master}"',
        part("a", mass, start={"start_displacement": 1.0}, **keys),
        part("b", mass, **keys),
        part("pair", pair, start={"stiffness": 2.0, "ground_stiffness": 3.0}, **keys),
        wires(
            *(
                wire
                for mass, port in (("a", "first"), ("b", "second"))
                for wire in (
                    f"{mass}.displacement -> pair.{port}.displacement",
                    f"{mass}.velocity -> pair.{port}.velocity",
                    f"pair.{port}.value -> {mass}.force",
                )
            )
        ),
        stop=stop,
        more=more,
    )


@pytest.mark.parametrize(
    ("versions", "rollback", "master", "error"),
    [
        ((2, 2), True, "interface-newton", 3e-4),
        ((3, 3), True, "iterative", 3e-4),
        ((2, 2), False, "extrapolated", 6e-4),
        ((3, 3), False, "extrapolated", 6e-4),
        ((3, 2), False, "gauss-seidel", 6e-2),
    ],
)
def test_two_masses_follow_the_closed_form_isolated_or_not(
    versions: tuple[int, int],
    rollback: bool,
    master: str,
    error: float,
    shelf: Shelf,
    tmp_path: Path,
) -> None:
    """x1 = (cos wt + cos Wt)/2 with w^2 = 3, W^2 = 7, and x2 with a minus between."""
    apart, together = (
        ran(masses(tmp_path, shelf, versions, master=master, isolate=isolate, rollback=rollback))
        for isolate in (None, False)
    )
    slow, fast = (np.cos(np.sqrt(square) * apart.times) for square in (3.0, 7.0))
    assert np.abs(apart.series("a.displacement") - 0.5 * (slow + fast)).max() < error
    assert np.abs(apart.series("b.displacement") - 0.5 * (slow - fast)).max() < error
    assert apart.rows.tobytes() == together.rows.tobytes()
    assert (apart.calls, apart.rollbacks) == (together.calls, together.rollbacks)


def test_steps_by_tolerance_are_the_same_isolated_or_not(shelf: Shelf, tmp_path: Path) -> None:
    more = "tolerance = 1e-3"
    apart, together = (
        ran(masses(tmp_path, shelf, master="extrapolated", more=more, isolate=isolate, stop=1.0))
        for isolate in (True, False)
    )
    assert apart.rejected == together.rejected
    assert apart.points == together.points
    assert apart.rows.tobytes() == together.rows.tobytes()
    slow, fast = (np.cos(np.sqrt(square) * apart.times) for square in (3.0, 7.0))
    assert np.abs(apart.series("a.displacement") - 0.5 * (slow + fast)).max() < 1e-2


def test_foreign_units_are_isolated_and_ours_are_not(
    shelf: Shelf, library: Path, tmp_path: Path
) -> None:
    ours, theirs = part("ours", "payload"), part("theirs", shelf("MASS", 2))
    held = hold({"ours.force.value": 0.0, "theirs.force": 0.0})
    with System(load(scenario(tmp_path, ours, theirs, held), library=library)) as system:
        assert [len(hosts()), len(system.instances)] == [1, 2]
    assert hosts() == []
    with System(load(scenario(tmp_path, ours, hold({"ours.force.value": 0.0})), library=library)):
        assert hosts() == []


def test_ours_are_the_same_isolated(library: Path, tmp_path: Path) -> None:
    def rows(isolate: bool) -> bytes:
        ours = part("p", "payload", isolate=isolate)
        path = scenario(tmp_path, ours, hold({"p.force.value": 0.01}))
        return ran(path, library=library).rows.tobytes()

    assert rows(True) == rows(False)


# ---------------------------------------------------------------------------------------- types


def echoed(version: int, end: int) -> dict[str, tuple[float, float, float]]:
    """Input of a first TYPES, its output, and that of a second one behind it, by type."""
    found: dict[str, tuple[float, float, float]] = {}
    reals = ("real",) if version == 2 else ("float64", "float32")
    wholes = ("integer",) if version == 2 else tuple(set(RANGES) - {"integer"})
    for name in reals:
        found[name] = (REALS[name][end],) * 3
    for name in wholes:
        start = RANGES[name][end] - 2 * end
        found[name] = (start, start + 1, start + 2)
    found["boolean"] = (float(end), 1.0 - end, float(end))
    found["enumeration"] = (1.0 + end,) * 3
    return found


def as_held(name: str, value: float) -> Value:
    """A held value as a scenario has it."""
    if name == "boolean":
        return bool(value)
    return ("slow", "fast")[int(value) - 1] if name == "enumeration" else value


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


def typed(
    folder: Path,
    fmu: Path,
    version: int,
    *texts: str,
    start: Mapping[str, Value] | None = None,
    isolate: bool = False,
    held: Mapping[str, Value] | None = None,
) -> Path:
    """A scenario with a TYPES `a` and a TYPES `b`, all inputs held that nothing else is said of."""
    names = {*echoed(version, 0)} | ({f"array[{k}]" for k in (1, 2, 3)} if version == 3 else set())
    fed = " ".join(texts) + " "
    usual = {
        f"{unit}.in_{name}": as_held(name, 1.0)
        for unit in "ab"
        for name in names
        if f"-> {unit}.in_{name} " not in fed
    }
    parts = [part("a", fmu, isolate=isolate, start=start or {}), part("b", fmu, isolate=False)]
    return scenario(folder, *parts, wires(*texts), hold({**usual, **(held or {})}), stop=0.02)


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
    unit = part("a", shelf("TYPES", 3), isolate=isolate, start={"in_array[3]": 7.0})
    held = hold({**names, "a.in_array[1]": 5.0})
    values = last(ran(scenario(tmp_path, unit, held, stop=0.02)))
    assert [values[f"a.out_array[{k}]"] for k in (1, 2, 3)] == [10.0, 0.0, 14.0]


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
def test_matrix_is_a_parameter_by_element(isolate: bool, shelf: Shelf, tmp_path: Path) -> None:
    names = {f"a.in_{name}": as_held(name, 1.0) for name in echoed(3, 0)}
    start: dict[str, Value] = {"in_matrix[1,2]": 5.0, "in_matrix[2,2]": -1.0}
    unit = part("a", shelf("TYPES", 3), isolate=isolate, start=start)
    held = hold({**names, "a.in_array[1]": 0.0})
    values = last(ran(scenario(tmp_path, unit, held, stop=0.02)))
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
        with pytest.raises(InitialisationError, match=r"a: fmi\dSetString: error: no text"):
            ran(path)


@each_version
def test_choices_and_truths_start_by_name(version: int, shelf: Shelf, tmp_path: Path) -> None:
    fmu = shelf("TYPES", version)
    start: dict[str, Value] = {"in_boolean": True, "in_enumeration": "fast"}
    plan = load(typed(tmp_path, fmu, version, start=start))
    assert plan.starts["a"] == {"in_boolean": 1.0, "in_enumeration": 2.0}


@pytest.fixture
def alone(shelf: Shelf, tmp_path: Path) -> Iterator[Callable[..., Instance]]:
    """A TYPES outside any scenario."""
    units: list[Instance] = []

    def opened(version: int, isolate: bool) -> Instance:
        path = shelf("TYPES", version)
        extract(path, tmp_path / "unpacked")
        units.append(open_instance("types", read_interface(path), tmp_path / "unpacked", isolate))
        return units[-1]

    yield opened
    for unit in units:
        unit.close()
        unit.close()


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_values_set_by_name_stay(
    version: int, isolate: bool, alone: Callable[..., Instance]
) -> None:
    """Setting one element of an array, then another, keeps the first; closing twice is safe."""
    unit = alone(version, isolate)
    names = ["out_boolean", "out_enumeration"]
    names += [f"out_matrix[{i},{j}]" for i in (1, 2) for j in (1, 2)] if version == 3 else []
    values = np.zeros(len(names))
    unit.connect([], np.zeros(0), [[unit.interface.variables[n] for n in names]], values)
    unit.prepare({"in_boolean": 1.0, "in_enumeration": 2.0}, 0.0, 1.0, None)
    if version == 3:
        unit.set({"in_matrix[1,1]": 9.0})
        unit.set({"in_matrix[2,1]": 8.0})
    unit.enter_initialisation()
    unit.receive()
    assert values.tolist() == [0.0, 2.0, 9.0, 8.0, 2.0, 4.0][: len(names)]


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


@pytest.mark.parametrize("name", ["int64", "uint64"])
def test_whole_number_beyond_doubles_ends_the_run(name: str, shelf: Shelf, tmp_path: Path) -> None:
    path = typed(tmp_path, shelf("TYPES", 3), 3, held={f"a.in_{name}": LARGEST})
    with pytest.raises(SimulationError, match=r"a: a U?Int64 output is beyond 2\^53"):
        ran(path)


# ---------------------------------------------------------------------------------------- loops


def ring(folder: Path, fmu: Path, gains: tuple[float, float], **keys: Value) -> Path:
    """Two GAINs, y1 = g1 y2 + 1 and y2 = g2 y1 + 0.5."""
    first = part("a", fmu, start={"gain": gains[0], "offset": 1.0}, **keys)
    second = part("b", fmu, start={"gain": gains[1], "offset": 0.5}, **keys)
    return scenario(folder, first, second, wires("a.y -> b.u", "b.y -> a.u"))


@pytest.mark.parametrize("gains", [(0.5, 1.0), (2.0, -2.0), (1.0, -1.0), (0.999, 1.0), (1e4, -1e4)])
@each_version
def test_loop_is_solved(
    gains: tuple[float, float], version: int, shelf: Shelf, tmp_path: Path
) -> None:
    """By passes where they contract, by Newton's method where they do not."""
    outcome = ran(ring(tmp_path, shelf("GAIN", version), gains, isolate=gains == (2.0, -2.0)))
    first = (0.5 * gains[0] + 1.0) / (1.0 - gains[0] * gains[1])
    for row in outcome.rows:
        values = dict(zip(outcome.names, row.tolist(), strict=True))
        assert values["a.y"] == pytest.approx(first, rel=1e-5)
        assert values["b.y"] == pytest.approx(gains[1] * first + 0.5, rel=1e-9, abs=1e-9)
    assert 0.0 <= outcome.residual < 1e-9


@pytest.mark.parametrize("gains", [(1.0, 1.0), (2.0, 0.5), (3.0, 1.0 / 3.0)])
@each_version
def test_loop_without_a_solution_is_refused(
    gains: tuple[float, float],
    version: int,
    shelf: Shelf,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The residual of z = z + 1 is small beside a large z: that is no solution."""
    monkeypatch.chdir(tmp_path)
    path = ring(tmp_path, shelf("GAIN", version), gains, isolate=gains == (1.0, 1.0))
    result = CliRunner().invoke(cli.app, ["run", str(path), "--output", "out.nc"])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"resilin: {path}: ")
    assert "does not settle at the start" in line
    assert "a.y = " in line or "b.y = " in line
    assert not list(tmp_path.glob("out*"))


def law_loop(folder: Path, shelf: Shelf, version: int, gain: float, actions: str) -> Path:
    """x1 = gain F, F = -(k + 1) x1 + k x2 with x2 held: a loop with something to change."""
    real = "real" if version == 2 else "float64"
    types, pair, mass = (shelf(model, version) for model in ("TYPES", "PAIR", "MASS"))
    held = {f"t.in_{name}": as_held(name, 1.0) for name in echoed(version, 0) if name != real}
    held |= {"t.in_array[1]": 0.0} if version == 3 else {}
    held |= {"p.second.displacement": 1.0, "p.second.velocity": 0.0, "m.force": 0.0}
    return scenario(
        folder,
        part("p", pair),
        part("t", types, isolate=False),
        part("m", mass, isolate=False),
        wires(
            f"p.first.value -> t.in_{real}",
            f"t.out_{real} -> p.first.displacement * {gain}",
            "m.velocity -> p.first.velocity",
        ),
        hold(held),
        actions,
    )


ACTIONS = """
[[actions]]
at = "0.03 s"
set = { "p.second.displacement" = "3 m" }
[[actions]]
at = "0.065 s"
set = { "p.stiffness" = "2 N/m" }
"""


@pytest.mark.parametrize("gain", [-0.25, 2.0], ids=["passes", "newton"])
@each_version
def test_loop_is_solved_again_in_mid_run(
    gain: float, version: int, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = ran(law_loop(tmp_path, shelf, version, gain, ACTIONS))
    forces = [k * x / (1.0 + gain * (k + 1.0)) for k, x in ((1.0, 1.0), (1.0, 3.0), (2.0, 3.0))]
    expected = np.repeat(forces, [3, 4, 4])
    assert outcome.series("p.first.value") == pytest.approx(expected, rel=1e-10)
    assert outcome.steps == 11


@each_version
def test_loop_that_loses_its_solution_ends_the_run(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    actions = ACTIONS.replace("2 N/m", "3 N/m")
    outcome = run(load(law_loop(tmp_path, shelf, version, -0.25, actions)))
    assert isinstance(outcome.failure, SimulationError)
    assert "is in an algebraic loop that does not settle" in str(outcome.failure)
    assert outcome.times == pytest.approx(0.01 * np.arange(7))


# --------------------------------------------------------------------------------------- faults


def sick(
    folder: Path,
    fmu: Path,
    fault: int,
    *beside: str,
    stop: float = 0.1,
    held: Mapping[str, Value] | None = None,
    **keys: Value,
) -> Path:
    """A FAULTY that strikes in the step to 0.05 s, beside what else there is."""
    start: dict[str, Value] = {"fault": fault, "fault_time": 0.05, "gain": 3.0}
    unit = part("sick", fmu, start=start, **{"patience": "1 s", **keys})
    return scenario(folder, unit, *beside, hold({"sick.u": 1.0, **(held or {})}), stop=stop)


@pytest.fixture
def prompt() -> Iterator[None]:
    """Whatever happens is over in little more than a unit's patience."""
    begun = time.monotonic()
    yield
    assert time.monotonic() - begun < 6.0


BOTH = (
    (1, "its process died of SIGSEGV"),
    (2, "no answer within 1 s; its process was stopped"),
    (3, "is not a finite number"),
    (4, "its process ended itself with exit code 0"),
    (5, "its process died of SIGABRT"),
    (8, "discard"),
    (9, "error: the bearing has seized"),
    (10, "fatal"),
)
OF_FMI_3 = (
    (11, "the unit returned early, at t = 0.045 s"),
    (12, "the unit asks for the end of the simulation"),
    (17, "the unit asks for event mode"),
)


@pytest.mark.usefixtures("prompt")
@pytest.mark.parametrize(
    ("version", "fault", "reason"),
    [(v, *entry) for v in VERSIONS for entry in BOTH] + [(3, *entry) for entry in OF_FMI_3],
)
def test_fault_ends_the_run_with_its_reason(
    version: int, fault: int, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = run(load(sick(tmp_path, shelf("FAULTY", version), fault)))
    message = str(outcome.failure)
    assert isinstance(outcome.failure, SimulationError)
    assert message.startswith("sick.y = nan 1 at t = 0.05 s" if fault == 3 else "sick: step from ")
    assert fault == 3 or "from t = 0.04 s by 0.01 s: " in message
    assert reason in message
    assert message.isprintable()
    assert outcome.times == pytest.approx(0.01 * np.arange(5))
    assert outcome.series("sick.y").tolist() == [3.0] * 5


@pytest.mark.usefixtures("prompt")
@each_version
def test_value_that_grows_without_end_ends_the_run(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = run(load(sick(tmp_path, shelf("FAULTY", version), 15, stop=2.0)))
    assert "sick.y = 1e+100 1 at t = 1.04 s is outside -1e+100 to 1e+100" in str(outcome.failure)
    assert len(outcome.times) == 104


@pytest.mark.usefixtures("prompt")
@each_version
def test_memory_without_end_ends_the_unit_alone(version: int, shelf: Shelf, tmp_path: Path) -> None:
    path = sick(tmp_path, shelf("FAULTY", version), 6, memory="300 MB", patience="5 s")
    outcome = run(load(path))
    assert "sick: step from t = 0.04 s" in str(outcome.failure)
    assert "SIGABRT, it seems for want of memory: it may take 300 MB" in str(outcome.failure)
    assert len(outcome.times) == 5


@pytest.mark.usefixtures("prompt")
@each_version
def test_flood_of_messages_is_capped(version: int, shelf: Shelf, tmp_path: Path) -> None:
    """10 MB of log with escape codes, and as much on stdout: the first and the last stay."""
    path = sick(tmp_path, shelf("FAULTY", version), 7)
    with System(load(path)) as system:
        unit = system.instances[0].instance
        for k in range(6):
            unit.step(0.01 * k, 0.01)
        assert len(unit.messages) == MOST_MESSAGES
        assert max(len(message) for message in unit.messages) < 520
        assert all(message.startswith("\\x1b[31mxxx") for message in unit.messages)
        assert all(message.isprintable() for message in unit.messages)
    assert len(ran(path).times) == 11


@pytest.mark.usefixtures("prompt")
@pytest.mark.parametrize("fault", [13, 16], ids=["crash", "hang"])
@each_version
def test_fault_at_the_very_end_costs_no_result(
    version: int, fault: int, shelf: Shelf, tmp_path: Path
) -> None:
    assert len(ran(sick(tmp_path, shelf("FAULTY", version), fault)).times) == 11


@pytest.mark.usefixtures("prompt")
@each_version
def test_unit_that_hangs_when_it_is_made_is_given_up(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    path = sick(tmp_path, shelf("FAULTY", version, fault=14), 14)
    with pytest.raises(InitialisationError, match="sick: instantiating: no answer within 1 s"):
        run(load(path))


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_unit_that_refuses_to_be_made_says_why(
    version: int, isolate: bool, shelf: Shelf, tmp_path: Path
) -> None:
    with (
        zipfile.ZipFile(shelf("FAULTY", version)) as old,
        zipfile.ZipFile(tmp_path / "other.fmu", "w") as new,
    ):
        for name in old.namelist():
            text = old.read(name)
            if name.endswith(".xml"):
                text = text.replace(b'guid="', b'guid="not-').replace(b'Token="', b'Token="not-')
            new.writestr(name, text)
    with pytest.raises(InitialisationError, match="sick: cannot be instantiated: refused: a wrong"):
        run(load(sick(tmp_path, tmp_path / "other.fmu", 0, isolate=isolate)))


@pytest.mark.usefixtures("prompt")
@pytest.mark.parametrize("fault", [1, 9], ids=["crash", "error"])
@pytest.mark.parametrize("master", ["gauss-seidel", "jacobi", "iterative", "interface-newton"])
def test_sick_unit_is_named_whatever_the_master(
    master: str, fault: int, shelf: Shelf, tmp_path: Path
) -> None:
    well = part("well", shelf("MASS", 2), isolate=False)
    chosen = f'[master]\nkind = "{master}"'
    held = {"well.force": 1.0}
    outcome = run(load(sick(tmp_path, shelf("FAULTY", 2), fault, well, chosen, held=held)))
    assert str(outcome.failure).startswith("sick: step from t = 0.04 s by 0.01 s: ")
    assert len(outcome.times) == 5


@pytest.mark.usefixtures("prompt")
@pytest.mark.parametrize(
    ("fault", "isolate", "reason"),
    [
        (1, True, "its process died of SIGSEGV"),
        (2, True, "no answer within 1 s; its process was stopped"),
        (8, True, "discard"),
        (9, True, "error: the bearing has seized"),
        (10, True, "fatal"),
        (10, False, "fatal"),
    ],
)
def test_attempts_at_shorter_steps_keep_the_reason(
    fault: int, isolate: bool, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    """A failing step is taken again, shorter, as long as the unit lives."""
    path = sick(tmp_path, shelf("FAULTY", 2), fault, isolate=isolate)
    outcome = run(load(path, time={"tolerance": 1e-3}))
    message = str(outcome.failure)
    assert message.startswith("sick: step from t = ")
    assert reason in message
    assert len(outcome.times) > 1


def test_sick_unit_on_the_command_line(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = sick(tmp_path, shelf("FAULTY", 3), 9)
    result = CliRunner().invoke(cli.app, ["run", str(path), "--output", "out.nc"])
    (line,) = result.stderr.splitlines()
    assert result.exit_code == 1
    assert line.startswith("resilin: sick: step from t = 0.04 s by 0.01 s: error: the bearing has")
    assert line.endswith("; 5 rows are kept in out.partial.nc")
    with xarray.open_dataset("out.partial.nc") as data:
        assert (data.attrs["complete"], data.sizes["time"]) == (0, 5)
        assert "the bearing has seized" in data.attrs["reason"]


# --------------------------------------------------------------------------------- capabilities


@each_version
def test_what_can_be_once_in_a_process_gets_one_each(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    path = ring(tmp_path, shelf("GAIN", version, once=True), (0.5, 0.5))
    with System(load(path)):
        assert len(hosts()) == 2
    ran(path)
    path = ring(tmp_path, shelf("GAIN", version, once=True), (0.5, 0.5), isolate=False)
    with pytest.raises(InitialisationError, match=r"refused: .* a second instance"):
        run(load(path))


@each_version
def test_library_of_another_name_is_found(version: int, shelf: Shelf, tmp_path: Path) -> None:
    mass = shelf("MASS", version, library="other.so", name="misnamed")
    outcome = ran(scenario(tmp_path, part("m", mass), hold({"m.force": 2.0})))
    assert last(outcome)["m.displacement"] == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_two_libraries_of_other_names_are_refused(
    version: int, isolate: bool, shelf: Shelf, tmp_path: Path
) -> None:
    path = tmp_path / "two.fmu"
    path.write_bytes(shelf("MASS", version, library="other.so", name="misnamed").read_bytes())
    place = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(f"binaries/{place}/another.so", b"")
    reason = r"two\.fmu: no library mass\.so for .*, but another\.so, other\.so: which is it\?"
    with pytest.raises(FmuError, match=reason):
        run(load(scenario(tmp_path, part("m", path, isolate=isolate), hold({"m.force": 0.0}))))


def beside_a_square_wave(folder: Path, mass: Path, *, stop: float = 0.2, more: str = "") -> Path:
    """A mass beside our amplifier, whose square wave of 18 Hz jumps between the points."""
    inputs = ("command.top", "command.bottom", "top.charge", "bottom.charge")
    held = {f"amplifier.{name}": 0.0 for name in inputs}
    action = '[[actions]]\nat = "0.025 s"\nset = { "m.force" = 2.0 }'
    return scenario(
        folder,
        part("m", mass),
        part("amplifier", "amplifier", start={"waveform": "square", "frequency": "18 Hz"}),
        hold({"m.force": 0.0, **held}),
        action,
        stop=stop,
        more=more,
    )


@each_version
def test_steps_of_one_size_are_not_cut(
    version: int, shelf: Shelf, library: Path, tmp_path: Path
) -> None:
    """A timed action then waits for the next point: it acts from 0.03 s on, not from 0.025 s."""
    rigid = beside_a_square_wave(tmp_path, shelf("MASS", version, variable_step=False))
    outcome = ran(rigid, library=library)
    assert outcome.steps == outcome.calls["m"] == 20
    assert last(outcome)["m.velocity"] == pytest.approx(2.0 * 0.17, rel=1e-12)
    supple = beside_a_square_wave(tmp_path, shelf("MASS", version))
    outcome = ran(supple, library=library)
    jumps = 2 * 0.2 * 18
    assert 20 + 1 + int(jumps) <= outcome.steps <= 20 + 2 + int(jumps)
    assert last(outcome)["m.velocity"] == pytest.approx(2.0 * 0.175, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "reasons"),
    [
        ({"stop": 0.205}, ["time.stop: m takes steps of one size only", "0.205 s is no multiple"]),
        ({"more": "tolerance = 1e-3"}, ["time.tolerance: needs steps of any size, which m"]),
    ],
    ids=["stop", "tolerance"],
)
def test_what_steps_of_one_size_cannot_do_is_refused(
    options: dict[str, float | str],
    reasons: list[str],
    shelf: Shelf,
    library: Path,
    tmp_path: Path,
) -> None:
    mass = shelf("MASS", 2, variable_step=False)
    path = beside_a_square_wave(tmp_path, mass, **options)  # type: ignore[arg-type]
    with pytest.raises(ScenarioError) as caught:
        load(path, library=library)
    (line,) = caught.value.problems
    assert all(reason in line for reason in reasons), line


# ------------------------------------------------------------------------------- life and death


def begun(path: Path, temporary: Path) -> subprocess.Popen[str]:
    """A run as a process of its own, begun so far that its unit has a process too."""
    master = subprocess.Popen(
        [*COMMAND, str(path), "--output", str(path.parent / "out.nc")],
        env={**os.environ, "TMPDIR": str(temporary)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert awaited(lambda: hosts(master.pid) != [] or master.poll() is not None, 20.0)
    assert master.poll() is None, master.communicate()
    time.sleep(0.5)
    return master


@pytest.mark.parametrize("fault", [0, 2], ids=["busy", "hanging"])
def test_unit_follows_its_killed_master(
    fault: int, shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    """Only the folder for temporary files stays: nobody is left to remove it."""
    (tmp_path / "kept").mkdir()
    path = sick(tmp_path, shelf("FAULTY", 2), fault, stop=1e5, patience="600 s")
    master = begun(path, tmp_path / "kept")
    master.kill()
    master.communicate()
    assert awaited(lambda: marked(mark) == [], 2.0)


def test_interrupt_of_the_whole_group_keeps_the_rows(
    shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    path = sick(tmp_path, shelf("FAULTY", 3), 0, stop=1e5)
    master = begun(path, Path(tempfile.gettempdir()))
    os.killpg(master.pid, signal.SIGINT)
    _, stderr = master.communicate(timeout=20)
    assert master.returncode == 130
    assert marked(mark) == []
    (line,) = stderr.splitlines()
    assert line.startswith("resilin: stopped by SIGINT; ")
    with xarray.open_dataset(tmp_path / "out.partial.nc") as data:
        assert data.attrs["complete"] == 0
        assert data.sizes["time"] > 1


def test_master_that_is_stopped_and_goes_on_keeps_its_unit(shelf: Shelf, tmp_path: Path) -> None:
    """The time it was stopped for is not held against the unit."""
    path = sick(tmp_path, shelf("FAULTY", 2), 0, stop=1e5, patience="0.3 s")
    master = begun(path, Path(tempfile.gettempdir()))
    for number in (signal.SIGSTOP, signal.SIGCONT, signal.SIGINT):
        master.send_signal(number)
        time.sleep(1.0)
    assert "stopped by SIGINT" in master.communicate(timeout=20)[1]


def test_second_interrupt_ends_a_hanging_unit(shelf: Shelf, tmp_path: Path, mark: str) -> None:
    """The first waits for the unit to answer; the second does not, though it is patient."""
    path = sick(tmp_path, shelf("FAULTY", 2), 2, patience="600 s")
    master = begun(path, Path(tempfile.gettempdir()))
    for _ in range(2):
        os.killpg(master.pid, signal.SIGINT)
        time.sleep(0.2)
    _, stderr = master.communicate(timeout=6)
    assert master.returncode == 130
    assert "Traceback" not in stderr
    assert marked(mark) == []


@pytest.mark.usefixtures("prompt")
def test_interrupt_amid_an_answer_closes_all(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = sick(tmp_path, shelf("FAULTY", 2), 2, patience="600 s")

    def struck(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGUSR1, struck)
    main = threading.main_thread().ident or 0
    timer = threading.Timer(0.5, signal.pthread_kill, (main, signal.SIGUSR1))
    try:
        with pytest.raises(KeyboardInterrupt), System(load(path)) as system:
            timer.start()
            system.instances[0].instance.step(0.0, 1.0)
        system.close()
    finally:
        timer.join()
        signal.signal(signal.SIGUSR1, before)


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
def test_only_closing_is_left_to_a_closed_unit(
    isolate: bool, alone: Callable[..., Instance]
) -> None:
    unit = alone(2, isolate)
    unit.close()
    unit.close()
    if isolate:
        with pytest.raises(SimulationError, match="its process has been given up"):
            unit.step(0.0, 0.1)


def test_last_of_many_messages_is_kept(alone: Callable[..., Instance]) -> None:
    unit = alone(2, False)
    for k in range(3 * MOST_MESSAGES):
        unit.log(1, f"types: message {k}")
    assert len(unit.messages) == MOST_MESSAGES
    assert unit.messages[0] == "message 0"
    assert unit.said() == f": message {3 * MOST_MESSAGES - 1}"


def test_patience_is_for_calls_not_for_coming_up(shelf: Shelf, tmp_path: Path) -> None:
    path = shelf("MASS", 2)
    extract(path, tmp_path / "unpacked")
    limits = Limits(patience=0.1)
    unit = open_instance("m", read_interface(path), tmp_path / "unpacked", True, limits)
    unit.close()
    assert unit.messages == []


def test_process_that_cannot_be_started_is_told(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: object, **options: object) -> None:
        raise OSError(errno.EMFILE, "Too many open files")

    path = scenario(tmp_path, part("m", shelf("MASS", 2)), hold({"m.force": 0.0}))
    monkeypatch.setattr(subprocess, "Popen", full)
    with pytest.raises(InitialisationError, match=r"m: its process cannot be started \(Too many"):
        run(load(path))


def test_folder_of_an_fmu_is_no_place_for_modules(shelf: Shelf, tmp_path: Path) -> None:
    """What lies in an FMU under the name of a module is not imported by its process."""
    path = tmp_path / "trap.fmu"
    path.write_bytes(shelf("MASS", 2).read_bytes())
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("json.py", "raise SystemExit(7)")
        archive.writestr("orchestrator/__init__.py", "raise SystemExit(7)")
    ran(scenario(tmp_path, part("m", path), hold({"m.force": 0.0})))


@pytest.mark.parametrize(
    "answer",
    [
        b"z" + 8 * b"\0",
        b"k" + b"\xff" * 8,
        ANSWER.pack(b"k", 3, 0) + b"[1]",
        ANSWER.pack(b"k", 2, 0) + b"{]",
        ANSWER.pack(b"f", 40_000, 0) + 40_000 * b"[",
        ANSWER.pack(b"k", 15, 0) + b'{"messages": 3}',
    ],
    ids=["letter", "lengths", "list", "no JSON", "depth", "messages"],
)
def test_answer_that_is_none_is_told(answer: bytes) -> None:
    """The process of an isolated unit may say anything."""
    reading, writing = os.pipe()
    try:
        os.write(writing, answer)
        with pytest.raises(Garbled):
            read_answer(reading)
    finally:
        os.close(reading)
        os.close(writing)
