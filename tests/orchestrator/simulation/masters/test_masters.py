"""What holds for every master, and the order of each."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import ScenarioError, SimulationError
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import MASTERS
from orchestrator.simulation.run import run
from orchestrator.studies.reference.monolith import as_recorded, monolithic
from tests.conftest import Runner

KINDS = sorted(MASTERS)
QUICKER = [
    pytest.param(kind, marks=[pytest.mark.slow] if kind == "interface-newton" else [])
    for kind in KINDS
]
"""The same, with the one that takes as long as all others among the slow tests."""


def error(library: Path, kind: str, laws: str, steps: int) -> float:
    """Largest error of the displacement of oscillator 1 against the monolith, relative."""
    time = {"stop": "6 cycles"}
    base = load("oscillator-1", None, library, time={**time, "step": {"per_cycle": 10}})
    exact = as_recorded(run(monolithic(base, library)), base).series("payload.displacement")
    done = run(
        load(
            "oscillator-1", None, library,
            time={**time, "step": {"per_cycle": steps}}, master={"kind": kind, "laws": laws},
        )
    )  # fmt: skip
    assert done.failure is None
    found = done.series("payload.displacement")[:: steps // 10]
    return float(np.abs(found - exact).max() / np.abs(exact).max())


@pytest.mark.parametrize("kind", QUICKER)
def test_every_master_is_second_order_with_laws(library: Path, kind: str) -> None:
    coarse, fine = (error(library, kind, "curvature", n) for n in (80, 160))
    assert np.log2(coarse / fine) > 1.6
    assert fine < 3e-3


@pytest.mark.parametrize("kind", ["gauss-seidel", "jacobi"])
def test_held_values_are_first_order(library: Path, kind: str) -> None:
    coarse, fine = (error(library, kind, "held", n) for n in (400, 800))
    assert 0.8 < np.log2(coarse / fine) < 1.4


def test_sequence_beats_parallel_with_laws(library: Path) -> None:
    assert error(library, "gauss-seidel", "curvature", 80) < error(
        library, "jacobi", "curvature", 80
    )


@pytest.mark.parametrize("kind", QUICKER)
def test_the_vehicle_flies_with_every_master(outcome: Runner, kind: str) -> None:
    done = outcome(
        "flapping-spring-full-wings",
        master={"kind": kind},
        time={"stop": "4 cycles", "step": {"per_cycle": 100}},
    )
    assert done.failure is None
    assert 0.8e-3 < np.abs(done.series("linkage.displacement")).max() < 1.6e-3


@pytest.mark.parametrize("kind", QUICKER)
def test_a_coupling_too_stiff_is_stopped(outcome: Runner, kind: str) -> None:
    """Held values, stiffness a thousand times: bounded, or stopped; never 1e18."""
    done = outcome(
        "oscillator-1",
        {"spring.stiffness": "63500", "spring.loss_factor": "0"},
        master={"kind": kind, "laws": "held"},
        time={"stop": "40 cycles", "step": {"per_cycle": 20}},
    )
    assert np.abs(done.series("payload.displacement")).max() <= 1.0
    assert done.failure is None or isinstance(done.failure, SimulationError)


def test_a_master_that_needs_rollback_is_refused_at_load(library: Path, tmp_path: Path) -> None:
    """The error names what is lacking, and what would work; nothing is loaded for it."""
    with (
        zipfile.ZipFile(library / "payload.fmu") as old,
        zipfile.ZipFile(tmp_path / "plain.fmu", "w") as new,
    ):
        for name in old.namelist():
            text = old.read(name)
            if name == "modelDescription.xml":
                yes, no = (f'canGetAndSetFMUstate="{word}"'.encode() for word in ("true", "false"))
                assert yes in text
                text = text.replace(yes, no)
            new.writestr(name, text)
    scenario = tmp_path / "scenario.toml"
    scenario.write_text('extends = "oscillator-1"\n[components.payload]\nfmu = "./plain.fmu"\n')
    load(scenario, None, library)
    with pytest.raises(
        ScenarioError, match="needs rollback, which payload cannot do; gauss-seidel"
    ):
        load(scenario, None, library, master={"kind": "iterative"})
