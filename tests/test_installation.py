"""What is installed: all that a run needs, and nothing that only the checks need."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
FIRST = """
import sys
sys.modules.update(dict.fromkeys(sys.argv[1].split()))
from typer.testing import CliRunner
from orchestrator.cli import app
for command in (
    ["build", "payload", "--python", "--into", "."],
    ["run", "oscillator-1", "--stop", "2 cycles", "--fmus", sys.argv[2], "--output", "out.nc"],
):
    CliRunner().invoke(app, command, catch_exceptions=False)
"""
"""What `make run` does, on a part; the modules of the first argument cannot be imported."""


def core() -> set[str]:
    """Packages that an installation without extras brings."""
    waiting = [Requirement(text) for text in PROJECT["project"]["dependencies"]]
    found = {"resilin"}
    while waiting:
        need = waiting.pop()
        name = canonicalize_name(need.name)
        if name in found or (need.marker and not need.marker.evaluate({"extra": ""})):
            continue
        found.add(name)
        waiting += map(Requirement, requires(name) or [])
    return found


def beyond() -> list[str]:
    """Modules that are here for the tests, and that an installation without extras lacks."""
    kept = core()
    return [
        module
        for module, owners in packages_distributions().items()
        if not kept.intersection(map(canonicalize_name, owners))
    ]


def test_building_and_running_need_the_core_alone(library: Path, tmp_path: Path) -> None:
    barred = beyond()
    assert {"distributed", "xarray", "pandas", "cryptography", "pytest"} <= set(barred)
    done = subprocess.run(
        [sys.executable, "-c", FIRST, " ".join(barred), str(library)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"payload.fmu", "out.nc", "out.png"}


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_the_first_command_installs_no_extra() -> None:
    done = subprocess.run(
        ["make", "-n", "-B", "run"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    installed = [line for line in done.stdout.splitlines() if "--editable" in line]
    assert [line.split("--editable ")[1] for line in installed] == ["."]


def test_every_data_file_is_installed() -> None:
    packages = PROJECT["tool"]["setuptools"]["package-data"]
    for package, patterns in packages.items():
        given = {path for pattern in patterns for path in (ROOT / package).glob(pattern)}
        there = {
            path
            for path in (ROOT / package).rglob("*.*")
            if path.is_file() and path.suffix not in {".py", ".pyc"}
        }
        assert sorted(there - given) == []
