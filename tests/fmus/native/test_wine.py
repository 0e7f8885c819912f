"""Native parts for Windows, run by Wine, against those for this machine."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import build_fmus
from fmus.native import link
from orchestrator.fmi.archive import extract
from tests.fmus.native.hosted import STEPS, answers, compiled_host, groups
from tests.fmus.native.pair import SIZES, slave_class
from tests.foreign.build import _compiler

WINE = shutil.which("wine64") or shutil.which("wine64", path="/usr/lib/wine")
SERVER = shutil.which("wineserver") or shutil.which("wineserver", path="/usr/lib/wine")
PARTS = build_fmus.compilable()
PLAIN = {"payload", "profile", "replay", "spring"}
"""Parts that call no function of libm but the square root: the same bits everywhere."""
ACCURACY = 1e-12
"""Of an output's largest value or the size of its unit; libraries round exp or acos otherwise."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(WINE is None or SERVER is None, reason="no wine64 here: apt install wine64"),
]


@pytest.fixture(scope="module")
def hosts(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The host for this machine and for Windows."""
    folder = tmp_path_factory.mktemp("hosts")
    (target,) = link.PLATFORMS["win64"].targets
    own = compiled_host(folder / "host", _compiler(), "-ldl")
    return own, compiled_host(folder / "host.exe", link.compiler(target, own=False))


@pytest.fixture(scope="module")
def windows(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Environment with a Windows of its own, shut down in the end."""
    folder = tmp_path_factory.mktemp("windows")
    environment = {**os.environ, "WINEPREFIX": str(folder), "WINEDEBUG": "-all"}
    yield environment
    assert SERVER is not None
    subprocess.run([SERVER, "-k"], env=environment, check=False)
    subprocess.run([SERVER, "-w"], env=environment, check=False)


@pytest.mark.parametrize("name", PARTS)
def test_windows_gets_the_same_digits(
    hosts: tuple[Path, Path], windows: dict[str, str], tmp_path: Path, name: str
) -> None:
    fmu = build_fmus.build(name, native=True, platforms=("linux64", "win64"), into=tmp_path).path
    extract(fmu, tmp_path / "parts")
    binaries = tmp_path / "parts" / "binaries"
    own, other = hosts
    rows = (STEPS + 1, -1)
    library = binaries / "linux64" / f"{name}.so"
    here = np.frombuffer(answers([own], fmu, library)).reshape(rows)
    library = binaries / "win64" / f"{name}.dll"
    there = np.frombuffer(answers([Path(str(WINE)), other], fmu, library, windows)).reshape(rows)
    if name in PLAIN:
        assert there.tobytes() == here.tobytes()
    variables = slave_class(name).part.variables
    units = [variables[k].quantity.unit for k in groups(name)["output"]]
    sizes = np.maximum(np.max(np.abs(here), axis=0), [SIZES.get(unit, 0.0) for unit in units])
    assert np.all(np.abs(there - here) <= ACCURACY * sizes)
