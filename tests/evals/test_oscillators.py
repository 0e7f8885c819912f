"""The five DEA-mass oscillators of table 1 and an electrode in closed form."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.conftest import Runner

PREDICTED = (51.8, 35.7, 25.2, 28.8, 50.5)
MEASURED = (52.0, 37.0, 26.0, 28.0, 51.0)
STIFFNESS = (63.5, 63.5, 63.5, 41.4, 127.0)
MASS = (0.603e-3, 1.26e-3, 2.538e-3, 1.26e-3, 1.26e-3)


def phase_at(outcome: Runner, scenario: str, frequency: float) -> float:
    """Lag behind the electrostatic force, taken against V^2 at the electrodes [rad]."""
    done = outcome(scenario, {"amplifier.frequency": f"{frequency} Hz"})
    return {m.name: m.value for m in metrics(dataset(done), 10)}["phase"]


@pytest.mark.parametrize("k", range(5))
def test_resonance_by_phase(outcome: Runner, k: int) -> None:
    """The frequency at which the displacement lags by 90 degrees is sqrt(K/M)/(2 pi)."""
    scenario = f"oscillator-{k + 1}"
    low, high = 0.98 * PREDICTED[k], 1.02 * PREDICTED[k]
    one, other = phase_at(outcome, scenario, low), phase_at(outcome, scenario, high)
    found = low + (0.5 * math.pi - one) / (other - one) * (high - low)
    assert found == pytest.approx(math.sqrt(STIFFNESS[k] / MASS[k]) / (2 * math.pi), rel=2e-3)
    assert found == pytest.approx(PREDICTED[k], rel=5e-3)
    assert found == pytest.approx(MEASURED[k], rel=4e-2)


CHARGING = """
[time]
stop = 0.02
step = {step}
[components.amplifier]
fmu = "amplifier"
start = {{ waveform = "constant", amplitude = "1 kV", resistance = "1 Mohm" }}
[components.spring]
fmu = "spring"
start = {{ blocked_force = 0.0 }}
[[wires]]
from = "amplifier.top"
to = "spring.top"
[[wires]]
from = "spring.top"
to = "amplifier.top"
[hold]
"amplifier.command.top" = 0
"amplifier.bottom.charge" = 0
"spring.bottom.voltage" = 0
"spring.motion.displacement" = 0
[record]
variables = ["amplifier.top.voltage", "spring.electrical_energy"]
"""


@pytest.mark.parametrize("step", [1e-5, 1e-3, 2e-2])
def test_electrode_charging(library: Path, tmp_path: Path, step: float) -> None:
    """V = V0 (1 - exp(-t/RC)) at any communication step."""
    scenario = tmp_path / "charging.toml"
    scenario.write_text(CHARGING.format(step=step))
    outcome = run(load(scenario, None, library))
    exact = 1000.0 * -np.expm1(-outcome.times / (1e6 * 3.24e-9))
    np.testing.assert_allclose(outcome.series("amplifier.top.voltage"), exact, rtol=1e-9, atol=1e-6)
