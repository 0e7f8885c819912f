"""The compiled parts as FMUs of FMI 3: the same rows as of FMI 2, and what only FMI 3 has."""

from __future__ import annotations

import dataclasses
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.build import build_platform_binary
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from lxml import etree

import build_fmus
from orchestrator.fmi.description import read_interface
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.conftest import Runner
from tests.fmus.native.test_derivatives import random_row
from tests.fmus.test_parts import instance

PARTS = build_fmus.compilable()
SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
STEP = 1e-4


@pytest.mark.parametrize("name", PARTS)
def test_the_description_is_that_of_fmi2(native: Path, native_fmi3: Path, name: str) -> None:
    path = native_fmi3 / f"{name}.fmu"
    assert validate_fmu(str(path)) == []
    two, three = (read_interface(folder / f"{name}.fmu") for folder in (native, native_fmi3))
    assert three.warnings == ()
    assert [*three.variables] == [*two.variables, "time"]
    for variable in two.variables.values():
        kind = "Float64" if variable.kind == "Real" else variable.kind
        expected = dataclasses.replace(variable, kind=kind, initial="")
        found = three.variables[variable.name]
        assert dataclasses.replace(found, initial="") == expected


@pytest.mark.parametrize("name", PARTS)
def test_every_port_is_a_terminal(native_fmi3: Path, name: str) -> None:
    path = native_fmi3 / f"{name}.fmu"
    ports: dict[tuple[str, str], list[str]] = {}
    for v in read_interface(path).variables.values():
        if v.causality in {"input", "output"} and v.port:
            ports.setdefault((v.port, v.causality), []).append(v.name)
    schema = etree.XMLSchema(etree.parse(str(SCHEMAS / "fmi3TerminalsAndIcons.xsd")))
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        names = set(archive.namelist())
        assert b"<h1>" in archive.read("documentation/index.html")
    schema.assertValid(root)
    found = {}
    for terminal in root.iter("Terminal"):
        members = terminal.findall("TerminalMemberVariable")
        drawn = terminal.find("TerminalGraphicalRepresentation")
        icon = drawn.get("iconBaseName")
        found[terminal.get("name"), icon] = [member.get("variableName") for member in members]
        for member in members:
            whole = f"{terminal.get('name')}.{member.get('memberName')}"
            assert member.get("variableName") in {whole, member.get("memberName")}
        assert {f"terminalsAndIcons/{icon}.{kind}" for kind in ("svg", "png")} <= names
    assert found == ports
    assert {"terminalsAndIcons/icon.svg", "terminalsAndIcons/icon.png"} <= names


@pytest.mark.parametrize("name", PARTS)
def test_rows_are_those_of_fmi2(native: Path, native_fmi3: Path, tmp_path: Path, name: str) -> None:
    rows = []
    for folder in (native, native_fmi3):
        place = tmp_path / folder.name
        place.mkdir()
        rng = np.random.default_rng(11)
        with instance(folder / f"{name}.fmu", place) as (unit, interface, sent, got):
            inputs = interface.of("input")
            for k in range(200):
                sent[:] = random_row(inputs, rng, k * STEP)
                unit.send()
                unit.step(k * STEP, STEP)
                unit.receive()
                rows.append(got.copy())
    assert np.isfinite(rows).all()
    assert np.array_equal(rows[:200], rows[200:])


@pytest.mark.parametrize("scenario", ["flapping-full-wings", "oscillator-1"])
def test_scenarios_are_those_of_fmi2(outcome: Runner, native_fmi3: Path, scenario: str) -> None:
    two = outcome(scenario, time={"stop": "4 cycles"})
    three = run(load(scenario, None, native_fmi3, time={"stop": "4 cycles"}))
    assert three.names == two.names
    assert np.array_equal(two.rows, three.rows, equal_nan=True)


@pytest.mark.parametrize("name", ["payload"])
def test_another_tool_builds_it_from_its_sources(
    native_fmi3: Path, tmp_path: Path, name: str
) -> None:
    """fmpy and CMake, by the build description of FMI 3."""
    extract(str(native_fmi3 / f"{name}.fmu"), str(tmp_path / "fmu"))
    for library in (tmp_path / "fmu" / "binaries").rglob("*.*"):
        library.unlink()
    (tmp_path / "cmake").mkdir()
    build_platform_binary(tmp_path / "fmu", tmp_path / "cmake")
    assert [path.stem for path in (tmp_path / "fmu" / "binaries").rglob("*.*")] == [name]


def slave(path: Path, folder: Path, **made: Any) -> FMU3Slave:
    """An initialised instance by fmpy, with the options of its creation."""
    description = read_model_description(str(path))
    unit = FMU3Slave(
        guid=description.guid,
        unzipDirectory=extract(str(path), str(folder)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="unit",
    )
    unit.instantiate(**made)
    unit.enterInitializationMode(startTime=0.0)
    unit.exitInitializationMode()
    return unit


def reference(path: Path, name: str) -> int:
    return read_interface(path).variables[name].reference


@pytest.mark.parametrize("early", [True, False])
def test_the_edges_of_a_drive_are_events(native_fmi3: Path, tmp_path: Path, early: bool) -> None:
    """A step over an edge ends there where it may, and asks for event mode."""
    path = native_fmi3 / "amplifier.fmu"
    unit = slave(path, tmp_path, eventModeUsed=True, earlyReturnAllowed=early)
    period = 1.0 / read_interface(path).variables["frequency"].start
    edge = unit.getFloat64([reference(path, "next_event_time")])[0]
    assert 0.0 < edge <= period
    size = 0.7 * edge
    assert unit.doStep(0.0, size)[:3] == (False, False, False)
    event, ended, returned, reached = unit.doStep(size, size)
    assert not ended
    if early:
        assert (event, returned) == (True, True)
        assert reached == pytest.approx(edge, abs=1e-12)
        unit.enterEventMode()
        again, ends, _, _, defined, following = unit.updateDiscreteStates()
        assert (again, ends, defined) == (False, False, True)
        assert edge < following <= edge + period
        unit.enterStepMode()
        assert unit.doStep(reached, following - reached)[:3] == (True, False, False)
    else:
        assert (event, returned, reached) == (False, False, 2.0 * size)
    unit.terminate()
    unit.freeInstance()


def test_an_instance_without_event_mode_has_no_events(native_fmi3: Path, tmp_path: Path) -> None:
    unit = slave(native_fmi3 / "amplifier.fmu", tmp_path)
    assert unit.doStep(0.0, 1.0)[:3] == (False, False, False)
    unit.terminate()
    unit.freeInstance()


def test_fmpy_runs_it(native_fmi3: Path) -> None:
    found = simulate_fmu(str(native_fmi3 / "payload.fmu"), stop_time=0.01, output_interval=1e-3)
    assert len(found) == 11


def test_a_library_of_another_build_is_refused(native_fmi3: Path, tmp_path: Path) -> None:
    path = native_fmi3 / "payload.fmu"
    with pytest.raises(Exception, match="Failed to instantiate"):
        description = read_model_description(str(path))
        FMU3Slave(
            guid="another",
            unzipDirectory=extract(str(path), str(tmp_path)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="unit",
        ).instantiate()


def test_fmi3_is_for_compiled_parts(tmp_path: Path) -> None:
    with pytest.raises(build_fmus.BuildError, match="--fmi 3 goes with --native"):
        build_fmus.build("payload", into=tmp_path, fmi=3)


def test_other_platforms_have_folders_of_their_own(tmp_path: Path) -> None:
    built = build_fmus.build(
        "payload", into=tmp_path, native=True, fmi=3, platforms=["darwin64", "win64"]
    )
    with zipfile.ZipFile(built.path) as archive:
        libraries = sorted(name for name in archive.namelist() if name.startswith("binaries/"))
    assert libraries == [
        "binaries/aarch64-darwin/payload.dylib",
        "binaries/x86_64-darwin/payload.dylib",
        "binaries/x86_64-windows/payload.dll",
    ]
