"""The membrane in whole scenarios: swap, energy, figures."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from orchestrator.results.outcome import Outcome
from tests.conftest import Runner


def test_energy_closes_over_fifty_cycles_without_loss(outcome: Runner) -> None:
    """Supplied = stored + dissipated in the electrodes, to 1e-5 of what was supplied."""
    done = outcome(
        "bench-silicone",
        {"spring.loss_factor": "0", "amplifier.frequency": "30 Hz", "amplifier.amplitude": "1500"},
        time={"stop": "50 cycles", "step": {"per_cycle": 200}},
    )
    assert done.failure is None
    last = {name: float(done.series(name)[-1]) for name in done.names}
    turned_over = float(np.abs(np.diff(done.series("amplifier.supplied_energy"))).sum())
    rest = last["amplifier.supplied_energy"] - last["amplifier.dissipated_energy"]
    rest -= last["spring.elastic_energy"] + last["spring.electrical_energy"]
    rest -= last["payload.kinetic_energy"]
    assert abs(rest) < 1e-5 * turned_over


@pytest.mark.parametrize(
    ("scenario", "component", "other", "moves"),
    [
        ("oscillator-1", "spring", "membrane", True),
        ("flapping-no-wing", "actuator", "spring", False),
        ("flapping-frames", "actuator", "spring", False),
        ("flapping-full-wings", "actuator", "spring", False),
        ("flapping-spring-full-wings", "actuator", "membrane", True),
    ],
)
def test_film_and_spring_take_each_other_s_place(
    outcome: Runner, tmp_path: Path, scenario: str, component: str, other: str, moves: bool
) -> None:
    """One line: another `fmu` in the component.

    The spring has a third of the film's force: less than the dry friction of the film's mechanism.
    """
    path = tmp_path / "swap.toml"
    swap = f'extends = "{scenario}"\n[components.{component}]\nfmu = "{other}"\n'
    path.write_text(swap)
    done = outcome(path, time={"stop": "5 cycles"})
    assert done.failure is None
    assert (travel(done) > 1e-4) == moves
    if not moves:
        path.write_text(f'{swap}[components.linkage.start]\ncoulomb_friction = "0 N"\n')
        assert travel(outcome(path, time={"stop": "5 cycles"})) > 1e-4


def travel(done: Outcome) -> float:
    """Peak to peak of the displacement, in m."""
    return float(np.ptp(done.rows[:, [n.endswith("displacement") for n in done.names]]))


def test_pull_test_is_linear_and_its_energy_is_the_work(outcome: Runner) -> None:
    """Figure 7: stiffness 85 N/m at L = 30 mm, passive force within 1 % of a line."""
    done = outcome("pull-test-L30")
    x, force = done.series("rig.displacement"), done.series("membrane.force.value")
    slope, offset = np.polyfit(x, force, 1)
    assert -slope == pytest.approx(85.0, rel=1e-2)
    assert np.abs(force - slope * x - offset).max() < 0.01 * np.abs(force).max()
    work = -np.trapezoid(force, x)
    energy = done.series("membrane.elastic_energy")
    assert energy[-1] - energy[0] == pytest.approx(work, abs=1e-6 * energy.max() + 1e-9)


def test_vhb_has_no_peak(outcome: Runner) -> None:
    """Figure 3: amplitude falls monotonically; 90 degrees near 52 Hz."""
    strokes = []
    for frequency in (2.0, 10.0, 25.0, 52.0, 90.0):
        cycles = max(3, round(0.4 * frequency))
        done = outcome(
            "bench-vhb", {"amplifier.frequency": f"{frequency} Hz"},
            time={"stop": f"{cycles} cycles"},
        )  # fmt: skip
        tail = done.series("payload.displacement")[-60:]
        strokes.append(float(np.ptp(tail)))
    assert all(b < a for a, b in pairwise(strokes))


def test_a_cone_driven_out_of_its_table_is_named(outcome: Runner) -> None:
    """The instance at fault is named, not the one that takes its outputs."""
    done = outcome("bench-silicone", {"payload.start_velocity": "20"}, time={"stop": "3 cycles"})
    assert str(done.failure).startswith("spring: ")
    assert "membrane's table" in str(done.failure)
