"""Directional derivatives of the compiled parts against differences of their outputs."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from numpy.typing import NDArray

import build_fmus
from orchestrator.fmi.description import read_interface
from tests.fmus.native.pair import COUNT, DOUBLE, ERROR, OK, POINTER, SIZES, Library

PARTS = build_fmus.compilable()
STEP = 1e-4
POINTS = 6
Row = NDArray[np.float64]


class Unit:
    """An instance of FMI 2 with rows for its inputs and outputs, in the order of the variables."""

    def __init__(self, path: Path, folder: Path) -> None:
        self._library = Library(path, folder)
        self.inputs = self._library.interface.of("input")
        self.outputs = self._library.interface.of("output")
        made = self._library.instantiate("unit")
        assert made is not None
        self._unit = made

    def call(self, name: str, *arguments: Any) -> int:
        return self._library.call(self._unit, name, *arguments)

    def initialise(self) -> None:
        setup = (0, DOUBLE(0.0), DOUBLE(0.0), 0, DOUBLE(0.0))
        assert self.call("SetupExperiment", *setup) == OK
        assert self.call("EnterInitializationMode") == OK

    def start(self) -> None:
        assert self.call("ExitInitializationMode") == OK

    def step(self, time: float) -> None:
        assert self.call("DoStep", DOUBLE(time), DOUBLE(STEP), 1) == OK

    def at(self, row: Row) -> Row:
        """Outputs with these inputs."""
        sent, got = np.ascontiguousarray(row), np.empty(len(self.outputs))
        if len(row):
            count, data = COUNT(len(row)), sent.ctypes.data_as(POINTER)
            assert self.call("SetReal", references(self.inputs), count, data) == OK
        given = (references(self.outputs), COUNT(len(got)), got.ctypes.data_as(POINTER))
        assert self.call("GetReal", *given) == OK
        return got

    def along(self, seed: Row) -> Row:
        """Derivative of all outputs along a direction of the inputs."""
        given, found = np.ascontiguousarray(seed), np.empty(len(self.outputs))
        status = self.call(
            "GetDirectionalDerivative",
            *(references(self.outputs), COUNT(len(found))),
            *(references(self.inputs), COUNT(len(given))),
            *(given.ctypes.data_as(POINTER), found.ctypes.data_as(POINTER)),
        )
        assert status == OK
        return found

    def close(self) -> None:
        self._library.free(self._unit)


def references(variables: Sequence[Any]) -> Any:
    return (ctypes.c_uint * len(variables))(*(v.reference for v in variables))


def scales(variables: Sequence[Any]) -> Row:
    """Size of each variable by its unit; a time by a step."""
    return np.array([STEP if v.unit == "s" else SIZES.get(v.unit, 1.0) for v in variables])


def random_row(inputs: Sequence[Any], rng: np.random.Generator, time: float) -> Row:
    """Inputs of plausible size; what ports refer to is a part of a step ago."""
    starts = np.array([float(v.start or 0.0) for v in inputs])
    row = 0.3 * scales(inputs) * rng.uniform(-1.0, 1.0, len(inputs))
    row = np.where(starts > 0.0, starts * rng.uniform(0.8, 1.2, len(inputs)), row)
    times = np.array([v.unit == "s" for v in inputs], dtype=bool)
    return np.where(times, time - rng.uniform(0.2, 0.8) * STEP, row)


def check(unit: Unit, row: Row, rng: np.random.Generator, seen: set[tuple[str, str]]) -> None:
    """Each input alone, and all together; at a kink differences do not settle and are left out."""
    sizes = scales(unit.inputs)
    alone = np.diag(sizes)
    for direction in [*alone, sizes * rng.uniform(-1.0, 1.0, len(sizes))]:
        slopes = unit.along(direction)
        rough, fine = (differences(unit, row, direction, width) for width in (2e-3, 1e-3))
        scale = np.maximum(np.abs(unit.at(row)), np.abs(fine))
        settled = np.abs(rough - fine) <= 3e-7 * scale + 1e-300
        bad = settled & (np.abs(slopes - fine) > 1e-6 * scale)
        named = [unit.outputs[k].name for k in np.flatnonzero(bad)]
        assert not named, (named, slopes[bad], fine[bad])
        for k in np.flatnonzero(settled):
            if slopes[k] != 0.0 and np.count_nonzero(direction) == 1:
                place = int(np.flatnonzero(direction)[0])
                seen.add((unit.outputs[k].name, unit.inputs[place].name))


def differences(unit: Unit, row: Row, direction: Row, width: float) -> Row:
    """Central differences of fourth order."""
    at = [unit.at(row + k * width * direction) for k in (-2, -1, 1, 2)]
    unit.at(row)
    return (8.0 * (at[2] - at[1]) - (at[3] - at[0])) / (12.0 * width)


@pytest.mark.parametrize("name", PARTS)
def test_against_differences(native: Path, tmp_path: Path, name: str) -> None:
    """In steps, at random inputs; every direct dependency is seen, and no other one."""
    unit = Unit(native / f"{name}.fmu", tmp_path)
    rng = np.random.default_rng(4)
    seen: set[tuple[str, str]] = set()
    unit.initialise()
    unit.start()
    for k in range(POINTS):
        unit.at(random_row(unit.inputs, rng, k * STEP))
        unit.step(k * STEP)
        row = random_row(unit.inputs, rng, (k + 1) * STEP)
        unit.at(row)
        check(unit, row, rng, seen)
    depends = {(v.name, source) for v in unit.outputs for source in v.depends or ()}
    assert seen <= depends
    assert bool(seen) == bool(depends)
    unit.close()


@pytest.mark.parametrize("name", ["spring", "amplifier", "aero"])
def test_before_the_first_step(native: Path, tmp_path: Path, name: str) -> None:
    """The initial state follows the inputs too."""
    unit = Unit(native / f"{name}.fmu", tmp_path)
    unit.initialise()
    rng = np.random.default_rng(5)
    row = random_row(unit.inputs, rng, 0.0)
    unit.at(row)
    seen: set[tuple[str, str]] = set()
    check(unit, row, rng, seen)
    assert seen
    unit.close()


def test_what_has_no_derivative_is_refused(native: Path, tmp_path: Path) -> None:
    unit = Unit(native / "spring.fmu", tmp_path)
    unit.initialise()
    one, seed, found = (ctypes.c_uint * 1), (DOUBLE * 1)(1.0), (DOUBLE * 1)()
    parameter = unit.inputs[-1].reference + 1
    output = unit.outputs[0].reference
    ask = "GetDirectionalDerivative"
    for unknown, known in ((output, parameter), (parameter, 0), (10_000, 0)):
        given = (one(unknown), COUNT(1), one(known), COUNT(1), seed, found)
        assert unit.call(ask, *given) == ERROR
    unit.close()


@pytest.mark.parametrize("name", PARTS)
def test_fmi3_gives_the_same(native: Path, native_fmi3: Path, tmp_path: Path, name: str) -> None:
    path = native_fmi3 / f"{name}.fmu"
    (tmp_path / "two").mkdir()
    two = Unit(native / f"{name}.fmu", tmp_path / "two")
    three = FMU3Slave(
        guid=read_interface(path).guid,
        unzipDirectory=extract(str(path), str(tmp_path / "three")),
        modelIdentifier=read_model_description(str(path)).coSimulation.modelIdentifier,
        instanceName="unit",
    )
    three.instantiate()
    row = 0.2 * scales(two.inputs)
    numbers = [v.reference for v in two.inputs]
    if numbers:
        three.setFloat64(numbers, row.tolist())
    three.enterInitializationMode(startTime=0.0)
    three.exitInitializationMode()
    two.initialise()
    two.at(row)
    two.start()
    outputs = [v.reference for v in two.outputs]
    for seed in np.diag(scales(two.inputs)):
        found = three.getDirectionalDerivative(outputs, numbers, seed.tolist())
        assert np.array_equal(found, two.along(seed))
    two.close()
    three.terminate()
    three.freeInstance()
