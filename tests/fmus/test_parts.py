"""What holds for every part: description, reference answer, rollback, life in a host."""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import gc
import importlib
import math
import subprocess
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from numpy.typing import NDArray

import build_fmus
from fmus import readme_tables
from fmus.export.build import build_part
from fmus.part import Part
from fmus.units import exponents
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import Interface, read_interface
from orchestrator.fmi.instance import InProcessInstance, in_process
from orchestrator.fmi.reference_answer import reference_deviation
from tests.processes import python

PARTS = build_fmus.part_names()


def part_of(name: str) -> Part:
    part: Part = importlib.import_module(f"fmus.{name}.slave").PART
    return part


@contextmanager
def instance(
    path: Path,
    folder: Path,
    start: dict[str, float | str] | None = None,
    name: str = "unit",
    initialised: bool = True,
) -> Iterator[tuple[InProcessInstance, Interface, Any, Any]]:
    """An initialised unit with buffers over all real inputs and outputs."""
    interface = read_interface(path)
    if not any(folder.iterdir()):
        extract(path, folder)
    unit = in_process(name, interface, folder)
    try:
        unit.prepare(start or {}, 0.0, 1.0, None)
        inputs = [v for v in interface.of("input") if v.kind in {"Real", "Float64"}]
        outputs = interface.of("output")
        sent = np.array([float(v.start or 0.0) for v in inputs])
        got = np.zeros(len(outputs))
        unit.connect(inputs, sent, [outputs], got)
        if initialised:
            unit.enter_initialisation()
            unit.send()
            unit.exit_initialisation()
        yield unit, interface, sent, got
    finally:
        unit.close()


def excite(sent: Any, interface: Interface) -> None:
    """Inputs of plausible size that make something happen."""
    _excite(sent, [variable.name for variable in interface.of("input")])


def _excite(sent: Any, names: list[str]) -> None:
    sizes = {
        "force.value": 0.05,
        "force.stiffness": 300.0,
        "motion.displacement": 5e-4,
        "motion.velocity": 0.05,
        "motion.flap_rate": 30.0,
        "motion.flap_angle": 0.1,
        "top.voltage": 1500.0,
        "bottom.voltage": 1100.0,
        "top.voltage_rate": 2e5,
        "bottom.voltage_rate": -3e5,
        "top.square_curvature": 1e13,
        "bottom.square_curvature": 1e13,
        "load.torque": -1e-5,
        "top.capacitance": 3.24e-9,
        "bottom.capacitance": 3.24e-9,
    }
    for index, name in enumerate(names):
        sent[index] = sizes.get(name, sent[index])


@pytest.mark.parametrize("name", PARTS)
def test_fmpy_and_the_toolbox_find_nothing(library: Path, name: str) -> None:
    path = library / f"{name}.fmu"
    assert validate_fmu(str(path)) == []
    script = (
        "import sys, logging, io\n"
        "from fmu_manipulation_toolbox.operations import FMU\n"
        "from fmu_manipulation_toolbox.checker import get_checkers\n"
        "stream = io.StringIO()\n"
        "logging.basicConfig(level=logging.WARNING, stream=stream)\n"
        "fmu = FMU(sys.argv[1])\n"
        "for check in get_checkers():\n"
        "    fmu.apply_operation(check())\n"
        "print(stream.getvalue(), end='')\n"
    )
    done = subprocess.run(
        python("-W", "ignore", "-c", script, path),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""


@pytest.mark.parametrize("name", PARTS)
def test_every_variable_has_unit_and_description(library: Path, name: str) -> None:
    interface = read_interface(library / f"{name}.fmu")
    for variable in interface.variables.values():
        assert variable.description, variable.name
        if variable.kind == "Real":
            exponents(variable.unit)


@pytest.mark.parametrize("name", [n for n in PARTS if n != "monolith"])
def test_declared_dependencies_are_the_true_ones(library: Path, tmp_path: Path, name: str) -> None:
    """Move each input alone: exactly the outputs that declare it change."""
    rng = np.random.default_rng(7)
    part = part_of(name)
    with instance(library / f"{name}.fmu", tmp_path) as (unit, interface, sent, got):
        excite(sent, interface)
        sent[:] = np.where(sent == 0.0, rng.uniform(0.5, 1.0, len(sent)), sent)
        for index, variable in enumerate(interface.of("input")):
            if variable.name.endswith(("reference_time", "_time")):
                sent[index] = -0.25e-3
        unit.send()
        unit.step(0.0, 1e-4)
        for index, variable in enumerate(interface.of("input")):
            if variable.name == "motion.reference_time":
                sent[index] = 0.5e-4
        unit.send()
        unit.receive()
        before = got.copy()
        moved: dict[str, set[str]] = {v.name: set() for v in interface.of("output")}
        for index, variable in enumerate(interface.of("input")):
            kept = sent[index]
            sent[index] = kept * 1.01
            unit.send()
            unit.receive()
            for output, now, then in zip(interface.of("output"), got, before, strict=True):
                if now != then:
                    moved[output.name].add(variable.name)
            sent[index] = kept
        declared = {
            v.name: {d.name for d in part.dependencies(v)}
            for v in part.variables
            if v.causality == "output"
        }
    for output, inputs in moved.items():
        assert inputs <= declared[output], output
    strict = {o for o in moved if o not in {"stroke", "frequency", "hover_mass", "limits"}}
    assert {o: moved[o] for o in strict} == {o: declared[o] for o in strict}


@pytest.mark.parametrize("name", PARTS)
def test_the_same_sources_give_the_same_file(tmp_path: Path, name: str) -> None:
    first = build_fmus.build(name, into=tmp_path / "a")
    second = build_fmus.build(name, into=tmp_path / "b")
    assert first.guid == second.guid
    assert first.path.read_bytes() == second.path.read_bytes()
    assert not build_fmus.build(name, into=tmp_path / "a").fresh


@pytest.mark.parametrize("name", PARTS)
def test_the_readme_holds_the_tables_of_the_code(name: str) -> None:
    text = (Path(readme_tables.HERE) / name / "README.md").read_text(encoding="utf-8")
    assert "<!-- parameters -->" in text
    assert readme_tables.filled(text, part_of(name)) == text
    for section in ("## Equations", "## Validity", "## Reference answer"):
        assert section in text


@pytest.mark.parametrize("name", PARTS)
def test_provenance_opens_with_its_kind(name: str) -> None:
    kinds = ("printed", "inferred", "calibrated", "assumed", "chosen")
    for variable in part_of(name).variables:
        if variable.causality == "parameter":
            assert variable.quantity.source.startswith(kinds), variable.name


@pytest.mark.parametrize("name", PARTS)
def test_the_reference_answer(library: Path, name: str) -> None:
    """Drive the FMU with the inputs of its CSV; the outputs come from closed forms."""
    reference = Path(readme_tables.HERE) / name / "reference.csv"
    found = reference_deviation(library / f"{name}.fmu", reference)
    assert found.error < part_of(name).accuracy, found


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("serialised", [False, True], ids=["state", "bytes"])
def test_rollback_is_bitwise(library: Path, tmp_path: Path, name: str, serialised: bool) -> None:
    with instance(library / f"{name}.fmu", tmp_path) as (unit, interface, sent, got):
        excite(sent, interface)
        h = 2e-4

        def three_steps(first: int) -> list[bytes]:
            rows = []
            for k in range(first, first + 3):
                unit.send()
                unit.step(k * h, h)
                unit.receive()
                rows.append(got.tobytes())
            return rows

        three_steps(0)
        state = unit.save()
        if serialised:
            state = _through_bytes(unit, state)
        once = three_steps(3)
        unit.restore(state)
        assert three_steps(3) == once
        unit.forget(state)


def _through_bytes(unit: InProcessInstance, state: Any) -> Any:
    """A state written to bytes and read back; FMI's own functions, which no master needs."""
    library, instance = unit._library, ctypes.c_void_p(unit._instance)
    size = ctypes.c_size_t()
    assert library.fmi2SerializedFMUstateSize(instance, state, ctypes.byref(size)) == 0
    buffer = ctypes.create_string_buffer(size.value)
    assert library.fmi2SerializeFMUstate(instance, state, buffer, size) == 0
    other = ctypes.c_void_p()
    read = library.fmi2DeSerializeFMUstate
    assert read(instance, buffer, size, ctypes.byref(other)) == 0
    return other


@pytest.mark.parametrize("name", PARTS)
def test_two_builds_and_three_instances_of_each_stay_apart(
    library: Path, tmp_path: Path, name: str
) -> None:
    """A variant and the plain part, three instances each, interleaved in one process."""
    parameter, changed, output = telling(part_of(name))
    build_part(part_of(name), alias=f"{name}_other", starts={parameter: changed}, into=tmp_path)
    paths = [library / f"{name}.fmu", tmp_path / f"{name}_other.fmu"]
    folders = [tmp_path / "one", tmp_path / "two"]
    for path, folder in zip(paths, folders, strict=True):
        folder.mkdir()
        extract(path, folder)
    finals: list[float] = []
    from contextlib import ExitStack

    with ExitStack() as stack:
        units = [
            stack.enter_context(instance(paths[k % 2], folders[k % 2], name=f"unit{k}"))
            for k in range(6)
        ]
        for unit, interface, sent, got in units:
            excite(sent, interface)
            unit.send()
            unit.step(0.0, 1e-4)
            unit.receive()
            place = [v.name for v in interface.of("output")].index(output)
            finals.append(float(got[place]))
    assert finals[0] == finals[2] == finals[4]
    assert finals[1] == finals[3] == finals[5]
    assert finals[0] != finals[1]


def telling(part: Part) -> tuple[str, float, str]:
    """A parameter, another value of it, and the output that it changes most after a step."""
    physics = part.physics
    sent = {v.name: v.start for v in part.variables if v.causality == "input"}
    names = list(sent)
    values = np.array([sent[name] for name in names])
    _excite(values, names)
    given = physics.Input(*map(float, values))

    def after(params: Any) -> NDArray[np.float64]:
        state = physics.initial(params, given, 0.0)
        state = physics.advance(params, state, given, 0.0, 1e-4)
        return np.array(dataclasses.astuple(physics.observe(params, state, given, 1e-4)))

    plain = after(physics.Params())
    parameters = [v for v in part.variables if v.causality == "parameter"]
    for v in sorted(parameters, key=lambda v: bool(v.quantity.choices)):
        most = math.inf if v.quantity.most is None else v.quantity.most
        sizes = (2.0 * v.start, 0.5 * v.start, 1e-2)
        others = (1.0, 2.0, 3.0) if v.quantity.choices else sizes
        for changed in others:
            if changed in (v.start, 0.0) or not (v.quantity.least or -math.inf) <= changed <= most:
                continue
            with contextlib.suppress(ValueError):
                moved = np.abs(after(physics.Params(**{v.field: changed})) - plain)
                if moved.max() > 0.0:
                    outputs = [o.name for o in part.variables if o.causality == "output"]
                    shares = moved / np.maximum(np.abs(plain), 1e-30)
                    return v.name, changed, outputs[int(np.argmax(shares))]
    raise AssertionError(f"no parameter of {part.name} changes an output")


HOST = """
import ctypes, os, sys
folder, identifier, guid, count = sys.argv[1:5]
assert not (sys.flags.no_site and any('site-packages' in path for path in sys.path))
library = ctypes.CDLL(f"{folder}/binaries/linux64/{identifier}.so")
Logger = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int,
                          ctypes.c_char_p, ctypes.c_char_p)
Allocate = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
Free = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
class Callbacks(ctypes.Structure):
    _fields_ = [("logger", Logger), ("allocate", Allocate), ("free", Free),
                ("finished", ctypes.c_void_p), ("environment", ctypes.c_void_p)]
libc = ctypes.CDLL(None)
libc.calloc.restype = ctypes.c_void_p
callbacks = Callbacks(Logger(lambda *a: print(a)), Allocate(lambda n, s: libc.calloc(n, s)),
                      Free(lambda p: libc.free(ctypes.c_void_p(p))), None, None)
library.fmi2Instantiate.restype = ctypes.c_void_p
library.fmi2Instantiate.argtypes = [ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p,
    ctypes.c_char_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_int]
def call(name, *arguments):
    function = getattr(library, name)
    status = function(ctypes.c_void_p(unit), *arguments)
    assert status == 0, (name, status)
for _ in range(int(count)):
    unit = library.fmi2Instantiate(b"unit", 1, guid.encode(), f"file://{folder}/resources".encode(),
                                   ctypes.addressof(callbacks), 0, 1)
    assert unit
    call("fmi2SetupExperiment", 0, ctypes.c_double(0), ctypes.c_double(0), 0, ctypes.c_double(0))
    call("fmi2EnterInitializationMode")
    call("fmi2ExitInitializationMode")
    for k in range(5):
        call("fmi2DoStep", ctypes.c_double(k * 1e-4), ctypes.c_double(1e-4), 1)
    call("fmi2Terminate")
    library.fmi2FreeInstance(ctypes.c_void_p(unit))
print("done", flush=True)
os._exit(0)  # PythonFMU's library may corrupt the heap when a process ends
"""


def _host(path: Path, folder: Path, count: int, *options: str) -> str:
    interface = read_interface(path)
    extract(path, folder)
    command = python(*options, "-c", HOST, folder, interface.identifier)
    done = subprocess.run([*command, interface.guid, str(count)], capture_output=True, text=True)
    return done.stdout.strip() + done.stderr[-500:]


@pytest.mark.parametrize("name", [n for n in PARTS if not part_of(n).needs])
def test_runs_on_the_standard_library_alone(library: Path, tmp_path: Path, name: str) -> None:
    assert _host(library / f"{name}.fmu", tmp_path, 1, "-I", "-S") == "done"


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] if part_of(n).needs else []) for n in PARTS],
)
def test_five_hundred_lives(library: Path, tmp_path: Path, name: str) -> None:
    alone = () if part_of(name).needs else ("-I", "-S")
    assert _host(library / f"{name}.fmu", tmp_path, 500, *alone) == "done"


@pytest.mark.parametrize("name", [n for n in PARTS if dataclasses.fields(part_of(n).physics.Input)])
def test_a_bad_input_is_refused_and_named(library: Path, tmp_path: Path, name: str) -> None:
    from orchestrator.errors import InstanceFailure

    with instance(library / f"{name}.fmu", tmp_path) as (unit, interface, sent, _):
        sent[0] = math.nan
        unit.send()
        first = interface.of("input")[0].name
        with pytest.raises(InstanceFailure, match=f"step.*discard.*{first} is nan"):
            unit.step(0.0, 1e-4)
        sent[0] = float(interface.of("input")[0].start or 0.0)
        unit.send()
        unit.step(0.0, 1e-4)
    gc.collect()


def test_the_archive_is_plain(library: Path) -> None:
    """No bytecode, no paths of this machine."""
    for name in PARTS:
        with zipfile.ZipFile(library / f"{name}.fmu") as archive:
            assert not [n for n in archive.namelist() if n.endswith(".pyc")]
            text = archive.read("modelDescription.xml").decode()
        assert str(Path.home()) not in text
