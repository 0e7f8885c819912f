"""Scenarios checked against FMUs: ports, laws, units, time."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.scenario.files import scenario_names
from orchestrator.scenario.plan import Plan
from orchestrator.simulation.load import load


@pytest.mark.parametrize("name", scenario_names())
def test_every_shipped_scenario_fits_its_fmus(library: Path, name: str) -> None:
    plan = load(name, None, library)
    assert plan.grid.count > 0
    assert plan.records


def wired(plan: Plan) -> set[str]:
    return {f"{c.target}.{c.input.name}" for c in plan.connections}


def test_laws_choose_the_members_that_are_wired(library: Path) -> None:
    names = {
        laws: wired(load("flapping-full-wings", None, library, master={"laws": laws}))
        for laws in ("held", "affine", "curvature")
    }
    assert "linkage.force.value" in names["held"]
    assert "linkage.force.stiffness" not in names["held"]
    assert "linkage.force.stiffness" in names["affine"]
    assert "linkage.force.curvature" not in names["affine"]
    assert names["held"] < names["affine"] < names["curvature"]


SCENARIO = """
[time]
stop = 0.01
step = 1e-4
[components.payload]
fmu = "payload"
[components.other]
fmu = "payload"
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "scenario.toml"
    path.write_text(SCENARIO + text)
    return path


def test_a_plain_number_stands_in_for_a_law(library: Path, tmp_path: Path) -> None:
    """A variable wired to a port feeds its first member; the rest keeps its start values."""
    scenario = written(
        tmp_path,
        '[[wires]]\nfrom = "other.force_work"\nto = "payload.force.value"\n'
        'gain = 2.0\n[hold]\n"other.force.value" = "1 N"\n',
    )
    with pytest.raises(ScenarioError, match="J is not convertible to N"):
        load(scenario, None, library)
    scenario = written(
        tmp_path,
        '[[wires]]\nfrom = "other.displacement"\nto = "payload.force.reference_displacement"\n'
        '[hold]\n"other.force.value" = "1 N"\n"payload.force.value" = "1 N"\n',
    )
    assert wired(load(scenario, None, library)) == {"payload.force.reference_displacement"}


@pytest.mark.parametrize(
    ("time", "count", "stop"),
    [
        ("stop = 0.01\nstep = 1e-3", 10, 0.01),
        ("stop = 0.01\nstep = 3e-3", 4, 0.01),
        ("start = 0.5\nstop = 1.0\nstep = 0.1", 5, 1.0),
        ('stop = "3 cycles"\nstep = { per_cycle = 20 }\nfrequency = "50 Hz"', 60, 0.06),
    ],
)
def test_the_grid(library: Path, tmp_path: Path, time: str, count: int, stop: float) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(
        f'[time]\n{time}\n[components.payload]\nfmu = "payload"\n'
        '[hold]\n"payload.force.value" = 0\n'
    )
    grid = load(path, None, library).grid
    assert grid.count == count
    assert grid.point(grid.count) == pytest.approx(stop)


def test_records_by_pattern(library: Path) -> None:
    names = {f"{c}.{v.name}" for c, v in load("oscillator-1", None, library).records}
    assert "payload.displacement" in names
    assert "spring.elastic_energy" in names
    assert "payload.motion.reference_time" not in names
