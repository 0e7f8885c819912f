"""Native parts in a process that has never heard of Python, and what they ask of it."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

import build_fmus
from fmus.native.translate import subset
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance.library import shared_library
from tests.fmus.native.hosted import SIZE, answers, compiled_host, groups, sent
from tests.fmus.native.pair import slave_class
from tests.foreign.build import _compiler

PARTS = build_fmus.compilable()
LIBM = {*subset.ARGUMENTS, "fmod"}
ALLOWED = LIBM | {
    "bcmp", "calloc", "free", "malloc", "memcmp", "memcpy", "memset", "snprintf", "strcmp",
    "__cxa_finalize", "__gmon_start__", "_ITM_deregisterTMCloneTable", "_ITM_registerTMCloneTable",
    "__stack_chk_fail", "strlen", "_setjmp", "longjmp",
}  # fmt: skip
"""libm, libc and what every compiler adds."""


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The host for this machine."""
    return compiled_host(tmp_path_factory.mktemp("host") / "host", _compiler(), "-ldl")


@pytest.mark.parametrize("name", PARTS)
def test_a_host_in_c_gets_the_same_bits(
    native: Path, host: Path, tmp_path: Path, name: str
) -> None:
    fmu = native / f"{name}.fmu"
    extract(fmu, tmp_path)
    found = answers([host], fmu, shared_library(read_interface(fmu), tmp_path))
    slave = slave_class(name)(instance_name="unit")
    references = groups(name)
    slave.setup_experiment(0.0, None, None)
    slave.exit_initialization_mode()
    own = [slave.get_real(references["output"])]
    for k, row in enumerate(sent(name)):
        slave.set_real(references["input"], row.tolist())
        assert slave.do_step(k * SIZE, SIZE)
        own.append(slave.get_real(references["output"]))
    assert found == np.array(own).tobytes()


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
