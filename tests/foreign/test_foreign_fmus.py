"""The foreign FMUs are what they claim to be: valid, loadable, faithful to their equations."""

from __future__ import annotations

import json
import math
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.validation import validate_fmu

from tests.foreign.build import foreign
from tests.foreign.host import FMICallException, Host, hosted
from tests.foreign.models import FAULTS, MODELS
from tests.processes import python

ROOT = Path(__file__).parents[2]
VERSIONS = (2, 3)
BUILT_IN = 14
EXTREMES = {
    "int8": (-(2**7), 2**7 - 1),
    "uint8": (0, 2**8 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint64": (0, 2**64 - 1),
}

each_version = pytest.mark.parametrize("version", VERSIONS)
each_model = pytest.mark.parametrize("model", MODELS)
Observed = dict[str, Any]
Lookup = Callable[[int, int], Observed]


def stir(host: Host, seed: int) -> None:
    """Give every input a value of its own."""
    for name, variable in host.variables.items():
        if variable.causality != "input":
            continue
        if variable.type == "Boolean":
            host.set(name, seed % 2 == 0)
        elif variable.type == "Enumeration":
            host.set(name, 1 + seed % 2)
        elif variable.type in {"Real", "Float32", "Float64"}:
            count = variable.shape[0] if variable.shape else 1
            host.set(name, [math.sin(seed + variable.valueReference + k) for k in range(count)])
        else:
            host.set(name, seed + variable.valueReference)


def bits(host: Host) -> str:
    """All values, distinguished to the last bit."""
    return repr(host.everything())


@each_model
@each_version
def test_description_is_valid(model: str, version: int, tmp_path: Path) -> None:
    path = foreign(model, tmp_path, version=version)
    assert validate_fmu(str(path)) == []
    described = fmpy.read_model_description(str(path))
    assert described.fmiVersion == f"{version}.0"
    assert described.coSimulation.canGetAndSetFMUstate


@each_model
@each_version
def test_starts_as_described_and_steps(model: str, version: int, tmp_path: Path) -> None:
    with hosted(foreign(model, tmp_path, version=version)) as host:
        for name, variable in host.variables.items():
            if variable.type in {"String", "Boolean"} or variable.start is None:
                continue
            value = host.get(name)
            values = value if isinstance(value, list) else [value]
            assert values == [float(text) for text in variable.start.split()], name
        host.start()
        for seed in range(3):
            stir(host, seed)
            host.step(0.01)
        assert host.time == pytest.approx(0.03)
        assert "nan" not in bits(host)


@each_model
@each_version
def test_state_comes_back_bit_by_bit(model: str, version: int, tmp_path: Path) -> None:
    def stepped(host: Host) -> str:
        for seed in (3, 4):
            stir(host, seed)
            host.step(0.1 / seed)
        return bits(host)

    with hosted(foreign(model, tmp_path, version=version)) as host:
        host.start()
        stir(host, 1)
        host.step(0.1)
        state, time, before = host.slave.getFMUState(), host.time, bits(host)
        after = stepped(host)
        assert after != before
        host.slave.setFMUState(state)
        host.time = time
        assert bits(host) == before
        assert stepped(host) == after
        host.slave.freeFMUState(state)


@each_version
def test_state_is_kept_back_where_rollback_is_denied(version: int, tmp_path: Path) -> None:
    path = foreign("MASS", tmp_path, version=version, rollback=False)
    assert not fmpy.read_model_description(str(path)).coSimulation.canGetAndSetFMUstate
    with hosted(path) as host:
        host.start()
        with pytest.raises(FMICallException, match="status 3"):
            host.slave.getFMUState()


@each_version
def test_reset_starts_anew(version: int, tmp_path: Path) -> None:
    with hosted(foreign("MASS", tmp_path, version=version)) as host:
        fresh = bits(host)
        host.start(start_velocity=1.0)
        host.step(0.1)
        host.slave.reset()
        assert bits(host) == fresh


@each_version
def test_steps_of_another_size_fail_where_denied(version: int, tmp_path: Path) -> None:
    path = foreign("GAIN", tmp_path, version=version, variable_step=False)
    cs = fmpy.read_model_description(str(path)).coSimulation
    assert not cs.canHandleVariableCommunicationStepSize
    with hosted(path) as host:
        host.start()
        host.step(0.1)
        host.step(0.1)
        with pytest.raises(FMICallException, match="status 3"):
            host.step(0.05)


@each_version
def test_once_is_once_in_a_process(version: int, tmp_path: Path) -> None:
    path = foreign("GAIN", tmp_path, version=version, once=True)
    cs = fmpy.read_model_description(str(path)).coSimulation
    assert cs.canBeInstantiatedOnlyOncePerProcess
    script = """
import sys, pathlib
from tests.foreign.host import hosted
for count in range(2):
    with hosted(pathlib.Path(sys.argv[1]), lambda status, text: print(text.decode())) as host:
        host.start()
        print("instance")
"""
    command = python("-c", script, path)
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    first, second = done.stdout.splitlines()
    assert first == "instance"
    assert "a second instance in this process" in second
    assert "Failed to instantiate" in done.stderr


def test_library_can_be_misnamed(tmp_path: Path) -> None:
    path = foreign("GAIN", tmp_path, library="other.so", name="misnamed")
    assert path == tmp_path / "misnamed.fmu"
    with zipfile.ZipFile(path) as archive:
        assert f"binaries/{fmpy.platform}/other.so" in archive.namelist()


def test_what_cannot_be_built_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no LEVER for FMI 2"):
        foreign("LEVER", tmp_path)
    with pytest.raises(ValueError, match="GAIN has no fault 1"):
        foreign("GAIN", tmp_path, fault=1)


@each_version
@pytest.mark.parametrize(("k", "d"), [(0.0, 0.0), (50.0, 0.0), (50.0, 0.6), (0.0, 0.6)])
def test_free_mass_follows_the_closed_form(
    k: float, d: float, version: int, tmp_path: Path
) -> None:
    m, x0, v0, t = 0.2, 0.01, -0.3, 0.7
    if k:
        decay, w = d / (2 * m), math.sqrt(k / m - (d / (2 * m)) ** 2)
        wave = x0 * math.cos(w * t) + (v0 + decay * x0) / w * math.sin(w * t)
        expected = math.exp(-decay * t) * wave
    else:
        expected = x0 + (v0 * m / d * -math.expm1(-d * t / m) if d else v0 * t)
    values = {"mass": m, "stiffness": k, "damping": d}
    with hosted(foreign("MASS", tmp_path, version=version)) as host:
        host.start(start_displacement=x0, start_velocity=v0, **values)
        assert (host.get("displacement"), host.get("velocity")) == (x0, v0)
        for _ in range(7):
            host.step(0.1)
        assert host.get("displacement") == pytest.approx(expected, rel=1e-7 if d else 1e-12)


@each_version
@pytest.mark.parametrize("k", [0.0, 50.0])
def test_held_force_is_answered_exactly(k: float, version: int, tmp_path: Path) -> None:
    m, force, t, w = 0.2, 3.0, 0.4, math.sqrt(k / 0.2)
    expected = force / k * (1.0 - math.cos(w * t)) if k else force / m * t**2 / 2
    with hosted(foreign("MASS", tmp_path, version=version)) as host:
        host.start(mass=m, stiffness=k)
        host.set("force", force)
        host.step(t)
        assert host.get("displacement") == pytest.approx(expected, rel=1e-13)


@each_version
def test_pair_puts_out_its_law_about_the_sample(version: int, tmp_path: Path) -> None:
    x, v, k, ground, d = (0.1, -0.2), (3.0, 5.0), 7.0, 11.0, 0.13
    with hosted(foreign("PAIR", tmp_path, version=version)) as host:
        host.start()
        host.step(0.5)
        for name, value in {"stiffness": k, "ground_stiffness": ground, "damping": d}.items():
            host.set(name, value)
        for port, displacement, velocity in zip(("first", "second"), x, v, strict=True):
            host.set(f"{port}.displacement", displacement)
            host.set(f"{port}.velocity", velocity)
        for port, i, j in (("first", 0, 1), ("second", 1, 0)):
            force = -ground * x[i] - k * (x[i] - x[j]) - d * (v[i] - v[j])
            assert host.get(f"{port}.value") == pytest.approx(force, rel=1e-14)
            assert host.get(f"{port}.stiffness") == k + ground
            assert host.get(f"{port}.damping") == d
            assert host.get(f"{port}.rate") == k * v[j]
            assert host.get(f"{port}.reference_displacement") == x[i]
            assert host.get(f"{port}.reference_velocity") == v[i]
            assert host.get(f"{port}.reference_time") == 0.5


@each_version
def test_gain_answers_at_once(version: int, tmp_path: Path) -> None:
    with hosted(foreign("GAIN", tmp_path, version=version)) as host:
        host.start(gain=-2.0, offset=0.5)
        host.set("u", 3.0)
        assert host.get("y") == -5.5
        with pytest.raises(FMICallException, match="status 3"):
            host.set("gain", 1.0)


@each_version
def test_types_are_echoed_now_and_a_step_later(version: int, tmp_path: Path) -> None:
    real, whole = ("real", "integer") if version == 2 else ("float64", "int32")
    with hosted(foreign("TYPES", tmp_path, version=version)) as host:
        host.start(in_string="Schlag")
        assert host.get("late_enumeration") == 1
        first = {f"in_{real}": 0.1, f"in_{whole}": 41, "in_boolean": True, "in_enumeration": 2}
        echoed = {real: 0.1, whole: 42, "boolean": False, "enumeration": 2}
        for name, value in first.items():
            host.set(name, value)
        assert {name: host.get(f"out_{name}") for name in echoed} == echoed
        host.step(0.1)
        host.set(f"in_{real}", 0.2)
        host.set("in_boolean", False)
        assert {name: host.get(f"late_{name}") for name in echoed} == echoed
        assert (host.get(f"out_{real}"), host.get("out_boolean")) == (0.2, True)
        text = host.get("out_string")
        assert (text.decode() if version == 2 else text) == "Schlag"


def test_types_of_fmi_3(tmp_path: Path) -> None:
    with hosted(foreign("TYPES", tmp_path, version=3)) as host:
        host.start(in_string="Flügel", in_matrix=[1.0, 2.0, 3.0, 4.0])
        for name, (least, most) in EXTREMES.items():
            for value, echo in ((least, least + 1), (most - 1, most), (most, most)):
                host.set(f"in_{name}", value)
                assert host.get(f"out_{name}") == echo
        host.set("in_float32", 0.1)
        assert host.get("out_float32") == pytest.approx(0.1, rel=1e-7)
        host.set("in_array", [1.0, -2.0, 0.5])
        assert host.get("out_array") == [2.0, -4.0, 1.0]
        assert host.get("out_matrix") == [1.0, 3.0, 2.0, 4.0]
        assert host.get("out_binary") == b"\x00\xff" + "Flügel".encode()
        host.step(0.25)
        assert host.get("time") == 0.25


@pytest.fixture(scope="module")
def observed(tmp_path_factory: pytest.TempPathFactory) -> Lookup:
    """How FAULTY ended, by version and fault: all run once, outside this process."""
    folder = tmp_path_factory.mktemp("faulty")
    jobs: dict[tuple[int, int], tuple[str, int | None]] = {}
    for version in VERSIONS:
        plain = str(foreign("FAULTY", folder, version=version, name=f"plain-{version}"))
        jobs |= {(version, fault): (plain, fault) for fault in FAULTS}
        built = foreign("FAULTY", folder, version=version, fault=BUILT_IN, name=f"built-{version}")
        jobs[version, BUILT_IN] = (str(built), None)
    command = python("-m", "tests.foreign.faults", json.dumps(list(jobs.values())))
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    found = dict(zip(jobs, json.loads(done.stdout), strict=True))
    return lambda version, fault: found[version, fault]


@each_version
@pytest.mark.parametrize(
    ("fault", "end"),
    [
        (1, "SIGSEGV"),
        (2, "hang"),
        (4, "exit 0"),
        (5, "SIGABRT"),
        (6, "SIGABRT"),
        (13, "SIGSEGV"),
        (14, "hang"),
        (16, "hang"),
    ],
)
def test_fault_ends_the_process(fault: int, end: str, version: int, observed: Lookup) -> None:
    assert observed(version, fault)["end"] == end
    assert "steps" not in observed(version, fault)


@each_version
@pytest.mark.parametrize(
    ("fault", "outputs"),
    [
        (0, ["3.0"] * 4),
        (3, ["3.0", "nan", "nan", "nan"]),
        (7, ["3.0"] * 4),
        (15, ["3.0", "13.0", "103.0", "1003.0"]),
    ],
)
def test_fault_shows_in_the_output(
    fault: int, outputs: list[str], version: int, observed: Lookup
) -> None:
    found = observed(version, fault)
    assert found["end"] == "exit 0"
    assert "status" not in found
    assert [step[1] for step in found["steps"]] == outputs


@each_version
def test_fault_floods_log_and_stdout(version: int, observed: Lookup) -> None:
    found = observed(version, 7)
    assert found["logged"] > 10_000_000
    assert found["stdout"] > 10_000_000
    assert found["last"].startswith("\x1b[31m")


@each_version
@pytest.mark.parametrize(("fault", "status"), [(8, 2), (9, 3), (10, 4)])
def test_fault_shows_in_the_status(fault: int, status: int, version: int, observed: Lookup) -> None:
    found = observed(version, fault)
    assert (found["end"], found["status"], len(found["steps"])) == ("exit 0", status, 1)
    assert found["last"] == ("the bearing has seized" if fault == 9 else "")


@pytest.mark.parametrize(("fault", "flag"), [(17, 0), (12, 1), (11, 2)])
def test_fault_shows_in_the_report_of_fmi_3(fault: int, flag: int, observed: Lookup) -> None:
    first, second = observed(3, fault)["steps"][:2]
    assert first[2] == [False, False, False, 0.25]
    assert [k for k in range(3) if second[2][k]] == [flag]
    assert second[2][3] == second[0] == (0.375 if fault == 11 else 0.5)
    assert [step[1] for step in observed(2, fault)["steps"]] == ["3.0"] * 4
