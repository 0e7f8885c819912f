"""Instances that take steps of one size only."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.simulation.load import load
from tests.foreign.scenarios import Shelf, each_version, hold, last, part, ran, scenario

pytestmark = pytest.mark.usefixtures("mark")


def beside_a_square_wave(folder: Path, mass: Path, *, stop: float = 0.2, more: str = "") -> Path:
    """A mass beside our amplifier, whose square wave of 18 Hz jumps between the points."""
    inputs = ("command.top", "command.bottom", "top.charge", "bottom.charge")
    held = {f"amplifier.{name}": 0.0 for name in inputs}
    action = '[[actions]]\nat = "0.025 s"\nset = { "m.force" = 2.0 }'
    return scenario(
        folder,
        part("m", mass),
        part("amplifier", "amplifier", start={"waveform": "square", "frequency": "18 Hz"}),
        hold({"m.force": 0.0, **held}),
        action,
        stop=stop,
        more=more,
    )


@each_version
def test_steps_of_one_size_are_not_cut(
    version: int, shelf: Shelf, library: Path, tmp_path: Path
) -> None:
    """A timed action then waits for the next point: it acts from 0.03 s on, not from 0.025 s."""
    rigid = beside_a_square_wave(tmp_path, shelf("MASS", version, variable_step=False))
    outcome = ran(rigid, library=library)
    assert outcome.steps == outcome.calls["m"] == 20
    assert "no step ends at the discontinuities that are announced" in outcome.unseen["m"]
    assert last(outcome)["m.velocity"] == pytest.approx(2.0 * 0.17, rel=1e-12)
    supple = beside_a_square_wave(tmp_path, shelf("MASS", version))
    outcome = ran(supple, library=library)
    assert outcome.unseen == {}
    jumps = 2 * 0.2 * 18
    assert 20 + 1 + int(jumps) <= outcome.steps <= 20 + 2 + int(jumps)
    assert last(outcome)["m.velocity"] == pytest.approx(2.0 * 0.175, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "reasons"),
    [
        (
            {"stop": 0.205},
            ["time.stop: m takes steps of one size only", "0.205 s is not a multiple"],
        ),
        ({"more": "tolerance = 1e-3"}, ["time.tolerance: needs steps of any size, which m"]),
    ],
    ids=["stop", "tolerance"],
)
def test_what_steps_of_one_size_cannot_do_is_refused(
    options: dict[str, float | str],
    reasons: list[str],
    shelf: Shelf,
    library: Path,
    tmp_path: Path,
) -> None:
    mass = shelf("MASS", 2, variable_step=False)
    path = beside_a_square_wave(tmp_path, mass, **options)  # type: ignore[arg-type]
    with pytest.raises(ScenarioError) as caught:
        load(path, library=library)
    (line,) = caught.value.problems
    assert all(reason in line for reason in reasons), line
