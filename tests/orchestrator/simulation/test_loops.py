"""Algebraic loops: solved, refused, and solved again in mid-run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.errors import SimulationError
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.scenarios import Shelf, each_version, hold, part, ran, ring, scenario, wires
from tests.foreign.types import as_held, echoed

pytestmark = pytest.mark.usefixtures("mark")


@pytest.mark.parametrize("gains", [(0.5, 1.0), (2.0, -2.0), (1.0, -1.0), (0.999, 1.0), (1e4, -1e4)])
@each_version
def test_loop_is_solved(
    gains: tuple[float, float], version: int, shelf: Shelf, tmp_path: Path
) -> None:
    """By passes where they contract, by Newton's method where they do not."""
    outcome = ran(ring(tmp_path, shelf("GAIN", version), gains, isolate=gains == (2.0, -2.0)))
    first = (0.5 * gains[0] + 1.0) / (1.0 - gains[0] * gains[1])
    for row in outcome.rows:
        values = dict(zip(outcome.names, row.tolist(), strict=True))
        assert values["a.y"] == pytest.approx(first, rel=1e-5)
        assert values["b.y"] == pytest.approx(gains[1] * first + 0.5, rel=1e-9, abs=1e-9)
    assert 0.0 <= outcome.residual < 1e-9


@pytest.mark.parametrize("gains", [(1.0, 1.0), (2.0, 0.5), (3.0, 1.0 / 3.0)])
@each_version
def test_loop_without_a_solution_is_refused(
    gains: tuple[float, float],
    version: int,
    shelf: Shelf,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The residual of z = z + 1 is small beside a large z, which is not a solution."""
    monkeypatch.chdir(tmp_path)
    path = ring(tmp_path, shelf("GAIN", version), gains, isolate=gains == (1.0, 1.0))
    result = CliRunner().invoke(cli.app, ["run", str(path), "--output", "out.nc"])
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"resilin: {path}: ")
    assert "does not settle at the start" in line
    assert "a.y = " in line or "b.y = " in line
    assert not list(tmp_path.glob("out*"))


def law_loop(folder: Path, shelf: Shelf, version: int, gain: float, actions: str) -> Path:
    """x1 = gain F, F = -(k + 1) x1 + k x2 with x2 held: a loop with something to change."""
    real = "real" if version == 2 else "float64"
    types, pair, mass = (shelf(model, version) for model in ("TYPES", "PAIR", "MASS"))
    held = {f"t.in_{name}": as_held(name, 1.0) for name in echoed(version, 0) if name != real}
    held |= {"t.in_array[1]": 0.0} if version == 3 else {}
    held |= {"p.second.displacement": 1.0, "p.second.velocity": 0.0, "m.force": 0.0}
    return scenario(
        folder,
        part("p", pair),
        part("t", types, isolate=False),
        part("m", mass, isolate=False),
        wires(
            f"p.first.value -> t.in_{real}",
            f"t.out_{real} -> p.first.displacement * {gain}",
            "m.velocity -> p.first.velocity",
        ),
        hold(held),
        actions,
    )


ACTIONS = """
[[actions]]
at = "0.03 s"
set = { "p.second.displacement" = "3 m" }
[[actions]]
at = "0.065 s"
set = { "p.stiffness" = "2 N/m" }
"""


@pytest.mark.parametrize("gain", [-0.25, 2.0], ids=["passes", "newton"])
@each_version
def test_loop_is_solved_again_in_mid_run(
    gain: float, version: int, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = ran(law_loop(tmp_path, shelf, version, gain, ACTIONS))
    forces = [k * x / (1.0 + gain * (k + 1.0)) for k, x in ((1.0, 1.0), (1.0, 3.0), (2.0, 3.0))]
    expected = np.repeat(forces, [3, 4, 4])
    assert outcome.series("p.first.value") == pytest.approx(expected, rel=1e-10)
    assert outcome.steps == 11


@each_version
def test_loop_that_loses_its_solution_ends_the_run(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    actions = ACTIONS.replace("2 N/m", "3 N/m")
    outcome = run(load(law_loop(tmp_path, shelf, version, -0.25, actions)))
    assert isinstance(outcome.failure, SimulationError)
    assert "is in an algebraic loop that does not settle" in str(outcome.failure)
    assert outcome.times == pytest.approx(0.01 * np.arange(7))
