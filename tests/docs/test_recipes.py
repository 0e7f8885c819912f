"""The recipes for other tools: each runs the vehicle, and with whole ports gets it right."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from orchestrator.scenario.ssp.write import Package, write_ssp
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.reference.monolith import as_recorded, monolithic
from tests.processes import fresh

RECIPES = Path(__file__).resolve().parents[2] / "docs" / "recipes"
OWN = {"cofmpy": Path(sys.prefix) / "cofmpy" / "bin" / "python"}
"""Tools with an environment of their own, which the Makefile makes."""
UNRUN = {"omsimulator"}
"""Its package cannot be installed from the index alone."""
SEQUENTIAL = {"cofmpy", "pathsim_fmi", "toolbox"}
TOOLS = sorted({p.stem.removeprefix("with_") for p in RECIPES.glob("with_*.py")} - UNRUN)
SCENARIO = "flapping-spring-full-wings"
"""On the film a parallel master extrapolates the square edge beyond the table."""
TIME = {"stop": "10 cycles", "step": {"per_cycle": 100}}
ANGLE = "linkage.flap_angle"


def stroke(angles: np.ndarray) -> float:
    """Peak to peak over the last cycle [deg]."""
    return math.degrees(float(np.ptp(angles[-101:])))


@pytest.fixture(scope="module")
def archives(native: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The scenario with plain numbers and with whole ports."""
    folder = tmp_path_factory.mktemp("recipes")
    made = {}
    for laws in ("held", "curvature"):
        plan = load(SCENARIO, None, native, time=TIME, master={"laws": laws})
        made[laws] = folder / f"{laws}.ssp"
        write_ssp(Package(plan, {}), made[laws])
    return made


@cache
def ours(library: Path, laws: str) -> float:
    master = {"laws": laws, "kind": "gauss-seidel"}
    return stroke(run(load(SCENARIO, None, library, time=TIME, master=master)).series(ANGLE))


@cache
def exact(library: Path) -> float:
    plan = load(SCENARIO, None, library, time=TIME)
    return stroke(as_recorded(run(monolithic(plan, library)), plan).series(ANGLE))


def recipe_result(tool: str, archive: Path) -> dict[str, float]:
    python = OWN.get(tool, Path(sys.executable))
    if not python.exists():
        pytest.skip(f"{tool} has an environment of its own: make {python.parent.parent}/ready")
    done = subprocess.run(
        fresh(python, RECIPES / f"with_{tool}.py", archive), capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[-2000:]
    found: dict[str, float] = json.loads(done.stdout.strip().splitlines()[-1])
    return found


@pytest.mark.parametrize("tool", TOOLS)
def test_whole_ports_give_the_stroke(library: Path, archives: dict[str, Path], tool: str) -> None:
    found = recipe_result(tool, archives["curvature"])
    assert found["frequency"] == pytest.approx(18.0, rel=2e-3)
    assert found["stroke"] == pytest.approx(exact(library), abs=0.1)
    if tool in SEQUENTIAL:
        assert found["stroke"] == pytest.approx(ours(library, "curvature"), abs=5e-3)


@pytest.mark.parametrize("tool", TOOLS)
def test_numbers_alone_are_degrees_off(library: Path, archives: dict[str, Path], tool: str) -> None:
    """What the laws are good for, in every tool: seven degrees in sequence, twenty in parallel."""
    found = recipe_result(tool, archives["held"])
    gain = abs(found["stroke"] - exact(library)) / 0.1
    assert gain > (60.0 if tool in SEQUENTIAL else 180.0)
    if tool in SEQUENTIAL:
        assert found["stroke"] == pytest.approx(ours(library, "held"), abs=5e-3)


def test_the_container_is_a_part_of_ours(
    library: Path, archives: dict[str, Path], tmp_path: Path
) -> None:
    """The toolbox's FMU of the whole vehicle, run by our master as one foreign unit."""
    made = tmp_path / "vehicle.fmu"
    done = subprocess.run(
        fresh(sys.executable, RECIPES / "with_toolbox.py", archives["curvature"], made),
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    scenario = tmp_path / "container.toml"
    scenario.write_text(
        '[time]\nstop = "10 cycles"\nfrequency = "18 Hz"\nstep = { per_cycle = 100 }\n'
        '[components.vehicle]\nfmu = "vehicle.fmu"\n'
    )
    outcome = run(load(scenario, None, library))
    assert outcome.failure is None
    found = stroke(outcome.series("vehicle.flap_angle"))
    assert found == pytest.approx(ours(library, "curvature"), abs=5e-3)


def test_the_document_names_every_recipe() -> None:
    text = (RECIPES.parent / "reference" / "exchange.md").read_text(encoding="utf-8")
    for path in RECIPES.glob("with_*.py"):
        assert f"recipes/{path.name}" in text
