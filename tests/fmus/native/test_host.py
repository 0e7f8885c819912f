"""Native parts in a process that has never heard of Python, and what they ask of it."""

from __future__ import annotations

import struct
import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest

import build_fmus
from fmus.native.translate import subset
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance.library import shared_library
from tests.fmus.native.pair import slave_class
from tests.foreign.build import _compiler
from tests.processes import fresh

PARTS = build_fmus.compilable()
SOURCE = Path(__file__).with_name("host.c")
STEPS = 60
SIZE = 1e-4
LIBM = {*subset.ARGUMENTS, "fmod"}
ALLOWED = LIBM | {
    "bcmp", "calloc", "free", "malloc", "memcmp", "memcpy", "memset", "snprintf", "strcmp",
    "__cxa_finalize", "__gmon_start__", "_ITM_deregisterTMCloneTable", "_ITM_registerTMCloneTable",
    "__stack_chk_fail", "strlen", "_setjmp", "longjmp",
}  # fmt: skip
"""libm, libc and what every compiler adds."""


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The host, compiled."""
    program = tmp_path_factory.mktemp("host") / "host"
    headers = Path(fmpy.__file__).parent / "c-code"
    command = [*_compiler(), "-std=gnu2x", "-O1", "-Wall", "-Werror", "-fno-sanitize=undefined"]
    command += [f"-I{headers}", str(SOURCE), "-o", str(program), "-ldl"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return program


@pytest.mark.parametrize("name", PARTS)
def test_a_host_in_c_gets_the_same_bits(
    native: Path, host: Path, tmp_path: Path, name: str
) -> None:
    fmu = native / f"{name}.fmu"
    extract(fmu, tmp_path)
    interface = read_interface(fmu)
    slave = slave_class(name)(instance_name="unit")
    groups = {
        kind: [k for k, v in enumerate(slave.part.variables) if v.causality == kind]
        for kind in ("input", "parameter", "output")
    }
    starts = np.array([slave.part.variables[k].start for k in groups["input"]])
    rows = starts * (1.0 + 0.1 * np.sin(np.arange(STEPS)[:, None] + np.arange(len(starts))))
    sizes = [str(len(group)) for group in groups.values()]
    library = shared_library(interface, tmp_path)
    done = subprocess.run(
        fresh(host, library, interface.guid, *sizes, STEPS, repr(SIZE)),
        input=rows.tobytes(),
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode()
    slave.setup_experiment(0.0, None, None)
    slave.exit_initialization_mode()
    own = [slave.get_real(groups["output"])]
    for k, row in enumerate(rows):
        slave.set_real(groups["input"], row.tolist())
        assert slave.do_step(k * SIZE, SIZE)
        own.append(slave.get_real(groups["output"]))
    assert done.stdout == np.array(own).tobytes()


def undefined(library: bytes) -> set[str]:
    """Names that a 64-bit ELF library takes from others, from its table of dynamic symbols."""
    (sections,) = struct.unpack_from("<Q", library, 0x28)
    size, count = struct.unpack_from("<HH", library, 0x3A)
    heads = [struct.unpack_from("<IIQQQQIIQQ", library, sections + k * size) for k in range(count)]
    dynamic = next(head for head in heads if head[1] == 11)
    strings = heads[dynamic[6]][4]
    names = set()
    for place in range(dynamic[4], dynamic[4] + dynamic[5], 24):
        name, info, _, section = struct.unpack_from("<IBBH", library, place)
        if section == 0 and name and info >> 4 in (1, 2):
            begin = strings + name
            names.add(library[begin : library.index(b"\0", begin)].decode())
    return names


@pytest.mark.parametrize("name", PARTS)
def test_only_the_c_library_is_asked_for(native: Path, tmp_path: Path, name: str) -> None:
    fmu = native / f"{name}.fmu"
    extract(fmu, tmp_path)
    library = shared_library(read_interface(fmu), tmp_path).read_bytes()
    names = undefined(library)
    assert "snprintf" in names
    assert names <= ALLOWED
    for trace in (b"Py_", b"PyErr", str(Path.home()).encode(), str(tmp_path).encode()):
        assert trace not in library
