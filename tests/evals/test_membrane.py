"""The membrane in whole scenarios: swap, energy, figures."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

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
    "scenario", ["oscillator-1", "flapping-no-wing", "flapping-frames", "flapping-full-wings"]
)
def test_the_membrane_takes_the_place_of_the_spring(
    outcome: Runner, tmp_path_factory: pytest.TempPathFactory, scenario: str
) -> None:
    """One line: another `fmu` in the component."""
    path = tmp_path_factory.mktemp("swap") / "swap.toml"
    path.write_text(f'extends = "{scenario}"\n[components.spring]\nfmu = "membrane"\n')
    done = outcome(path, time={"stop": "5 cycles"})
    assert done.failure is None
    assert np.ptp(done.rows[:, [n.endswith("displacement") for n in done.names]]) > 1e-4


def test_membrane_in_flight_converges(outcome: Runner) -> None:
    """Coupling error against eight times as many steps, below stops."""
    change = {"amplifier.amplitude": "1000"}
    name = "linkage.displacement"
    fine = outcome(
        "flapping-membrane", change, time={"stop": "4 cycles", "step": {"per_cycle": 400}}
    )
    size = np.abs(fine.series(name)).max()
    errors = []
    for steps in (50, 100):
        done = outcome(
            "flapping-membrane", change, time={"stop": "4 cycles", "step": {"per_cycle": steps}}
        )
        errors.append(np.abs(done.series(name) - fine.series(name)[:: 400 // steps]).max() / size)
    assert errors[0] < 1e-3
    assert errors[1] < errors[0]


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


@pytest.mark.parametrize(("voltage", "closure"), [("1000", 1e-3), ("1920", 1.5e-2)])
def test_energy_of_square_edges_on_a_film(outcome: Runner, voltage: str, closure: float) -> None:
    """The film's capacitance rises by a tenth over an edge of 1920 V; a tangent loses 27 %."""
    done = outcome(
        "flapping-membrane", {"amplifier.amplitude": voltage}, time={"stop": "20 cycles"}
    )
    last = {name: float(done.series(name)[-1]) for name in done.names}
    spent = sum(
        value
        for name, value in last.items()
        if name.endswith(("_loss", "dissipated_energy", "kinetic_energy", "stop_energy"))
    )
    spent += last["spring.elastic_energy"] + last["spring.electrical_energy"]
    spent += last["linkage.load_work"]
    supplied = last["amplifier.supplied_energy"]
    assert supplied == pytest.approx(spent, rel=closure)
