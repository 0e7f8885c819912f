"""Native parts stepped by the host in C."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

import fmpy
import numpy as np
from numpy.typing import NDArray

from orchestrator.fmi.description import read_interface
from tests.fmus.native.pair import SIZES, slave_class
from tests.processes import fresh

SOURCE = Path(__file__).with_name("host.c")
STEPS = 60
SIZE = 1e-4


def compiled_host(program: Path, compiler: Sequence[str], *libraries: str) -> Path:
    """The host, compiled."""
    headers = Path(fmpy.__file__).parent / "c-code"
    command = [*compiler, "-std=gnu2x", "-O1", "-Wall", "-Werror", "-fno-sanitize=undefined"]
    command += [f"-I{headers}", str(SOURCE), "-o", str(program), *libraries]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return program


def groups(name: str) -> dict[str, list[int]]:
    """Value references of a part by causality, in the order in which the host takes them."""
    variables = slave_class(name).part.variables
    return {
        kind: [k for k, v in enumerate(variables) if v.causality == kind]
        for kind in ("input", "parameter", "output")
    }


def sent(name: str) -> NDArray[np.float64]:
    """Inputs of each step, swung by a tenth of the start value, or of the size of its unit."""
    variables = slave_class(name).part.variables
    inputs = [variables[k] for k in groups(name)["input"]]
    starts = np.array([v.start for v in inputs])
    swings = np.array([v.start or SIZES.get(v.quantity.unit, 0.0) for v in inputs])
    return starts + 0.1 * swings * np.sin(np.arange(STEPS)[:, None] + np.arange(len(starts)))


def answers(
    host: Sequence[Path], fmu: Path, library: Path, environment: dict[str, str] | None = None
) -> bytes:
    """Outputs before the first step and after each, as the host writes them."""
    sizes = [len(group) for group in groups(fmu.stem).values()]
    done = subprocess.run(
        fresh(*host, library, read_interface(fmu).guid, *sizes, STEPS, repr(SIZE)),
        input=sent(fmu.stem).tobytes(),
        capture_output=True,
        check=False,
        env=environment,
    )
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout
