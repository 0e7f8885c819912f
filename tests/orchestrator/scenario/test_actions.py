"""Timed actions: parameters and held inputs set in mid-run, at their time and not before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import ScenarioError
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import MASTERS
from orchestrator.simulation.run import run
from tests.foreign.build import foreign

MASS = """
[time]
stop = 1.0
step = 0.1
[components.mass]
fmu = "payload"
start = { mass = 2.0 }
[hold]
"mass.force.value" = "0 N"
[[actions]]
at = "250 ms"
set = { "mass.force.value" = "4 N" }
[[actions]]
at = 0.75
set = { "mass.force.value" = 0 }
"""


@pytest.mark.parametrize("kind", sorted(MASTERS))
def test_a_held_force_acts_between_its_times(library: Path, tmp_path: Path, kind: str) -> None:
    """Steps end at the actions though these lie between points: 2 m/s2 over half a second."""
    scenario = tmp_path / "mass.toml"
    scenario.write_text(MASS)
    done = run(load(scenario, None, library, master={"kind": kind}))
    assert done.failure is None
    velocity = np.interp(done.times, [0.0, 0.25, 0.75, 1.0], [0.0, 0.0, 1.0, 1.0])
    assert done.series("mass.velocity") == pytest.approx(velocity, abs=1e-12)
    assert done.steps == 12


@pytest.mark.parametrize("rollback", [True, False])
def test_actions_survive_steps_that_are_taken_again(
    library: Path, tmp_path: Path, rollback: bool
) -> None:
    """An adaptive run ends steps at actions; a rejected step does not carry them out."""
    foreign("MASS", tmp_path, rollback=rollback)
    scenario = tmp_path / "mass.toml"
    text = MASS.replace('"payload"', '"./mass.fmu"').replace("mass.force.value", "mass.force")
    text += '[components.spring]\nfmu = "spring"\nstart = { blocked_force = 0.0 }\n'
    text += '[[wires]]\nfrom = "mass.displacement"\nto = "spring.motion.displacement"\n'
    text += '[record]\nvariables = ["mass.velocity"]\n'
    scenario.write_text(
        text.replace("[hold]", '[hold]\n"spring.top.voltage" = 0\n"spring.bottom.voltage" = 0')
    )
    done = run(load(scenario, None, library, time={"tolerance": 1e-4}))
    assert done.failure is None
    assert {0.25, 0.75} <= set(np.round(done.points, 12).tolist())
    assert done.series("mass.velocity")[-1] == pytest.approx(1.0, abs=1e-9)


def test_a_tunable_parameter_changes_the_drive(library: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "half.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[time]\nstop = "4 cycles"\n'
        '[[actions]]\nat = "2 cycles"\nset = { "amplifier.amplitude" = "960 V" }\n'
    )
    done = run(load(scenario, None, library))
    voltage = done.series("amplifier.top.voltage")
    half = len(voltage) // 2
    assert voltage[:half].max() > 1800.0
    assert 850.0 < voltage[half + 10 :].max() < 961.0


def test_a_parameter_out_of_bounds_is_refused(library: Path, tmp_path: Path) -> None:
    """A value outside the FMU's bounds is refused before anything runs."""
    scenario = tmp_path / "bad.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[time]\nstop = "4 cycles"\n'
        '[[actions]]\nat = "2 cycles"\nset = { "amplifier.amplitude" = "-5 V" }\n'
    )
    with pytest.raises(Exception, match=r"actions\[0\].set.amplifier.amplitude: '-5 V' is outside"):
        load(scenario, None, library)


def test_an_action_that_changes_nothing_is_refused(library: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "empty.toml"
    scenario.write_text('extends = "oscillator-1"\n[[actions]]\nat = 0.1\nset = {}\n')
    with pytest.raises(ScenarioError, match=r"actions\[0\].set: is empty"):
        load(scenario, None, library)
