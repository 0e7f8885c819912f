"""Runs: time labels, events, failures, masters, what is loaded and what is not."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import Divergence, InitialisationError, SimulationError
from orchestrator.scenario.files import scenario_names
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.conftest import Runner
from tests.processes import python

MAPS = Path("/proc/self/maps")
RAMP = """
[time]
stop = 0.0103
step = 1e-3
[components.source]
fmu = "payload"
start = { start_velocity = 1.0, mass = 1.0 }
[components.spring]
fmu = "spring"
start = { damping = 0.0, stiffness = 1.0, blocked_force = 0.0 }
[[wires]]
from = "source.motion"
to = "spring.motion"
[hold]
"source.force.value" = 0
"spring.top.voltage" = 0
"spring.bottom.voltage" = 0
[record]
variables = ["source.displacement", "spring.force.value"]
"""


@pytest.mark.parametrize("order", [["source", "spring"], ["spring", "source"]])
def test_values_carry_the_time_at_which_they_hold(
    library: Path, tmp_path: Path, order: list[str]
) -> None:
    """x = t: the displacement and the force that follows it equal their time label."""
    path = tmp_path / "ramp.toml"
    path.write_text(RAMP + f"[master]\norder = {order}\n")
    outcome = run(load(path, None, library))
    assert outcome.failure is None
    np.testing.assert_allclose(outcome.series("source.displacement"), outcome.times, atol=1e-15)
    np.testing.assert_allclose(outcome.series("spring.force.value"), -outcome.times, atol=1e-15)
    assert outcome.times[-1] == 0.0103


@pytest.mark.parametrize("name", scenario_names())
def test_every_scenario_runs(library: Path, outcome: Runner, name: str) -> None:
    """Three cycles of each; the whole run where a scenario has no cycle."""
    cyclic = load(name, None, library).frequency is not None
    done = outcome(name, time={"stop": "3 cycles"} if cyclic else {})
    assert done.failure is None
    assert np.isfinite(done.rows).all()


def test_steps_are_cut_at_announced_edges(outcome: Runner) -> None:
    """With 7 steps to a cycle the edge at half a cycle lies inside the fourth."""
    done = outcome("flapping-no-wing", time={"stop": "5 cycles", "step": {"per_cycle": 7}})
    assert done.steps == 35 + 5
    assert len(done.times) == 36


def test_an_odd_number_of_steps_is_as_accurate(outcome: Runner) -> None:
    odd = outcome(
        "flapping-spring-full-wings", time={"stop": "4 cycles", "step": {"per_cycle": 41}}
    )
    even = outcome(
        "flapping-spring-full-wings", time={"stop": "4 cycles", "step": {"per_cycle": 400}}
    )
    x = np.interp(odd.times, even.times, even.series("linkage.displacement"))
    assert np.abs(odd.series("linkage.displacement") - x).max() < 2e-3 * np.abs(x).max()


def test_divergence_is_stopped_and_named(outcome: Runner) -> None:
    """Held forces on a coupling a thousand times stiffer: growth without end."""
    done = outcome(
        "oscillator-1",
        {"spring.stiffness": "63500", "spring.loss_factor": "0"},
        master={"laws": "held"},
        time={"stop": "100 cycles", "step": {"per_cycle": 20}},
    )
    assert isinstance(done.failure, SimulationError)
    assert "payload" in str(done.failure) or "spring" in str(done.failure)
    assert 0 < len(done.times) < 2000


def test_bounds_that_an_fmu_declares_are_kept(outcome: Runner) -> None:
    done = outcome(
        "oscillator-1",
        {"payload.start_velocity": "9000", "spring.blocked_force": "0"},
        time={"stop": "20 cycles"},
    )
    assert isinstance(done.failure, Divergence)
    assert "payload.displacement" in str(done.failure)
    assert "outside -1 to 1 m" in str(done.failure)


def test_an_instance_that_fails_ends_the_run_with_its_message(outcome: Runner) -> None:
    done = outcome(
        "oscillator-1",
        {"payload.start_velocity": "100", "spring.stiffness": "0", "amplifier.amplitude": "0"},
    )
    assert "amplifier: step from t = 0 s" in str(done.failure)
    assert "capacitance falls to zero" in str(done.failure)


def test_an_instance_that_refuses_its_start_is_named(outcome: Runner) -> None:
    with pytest.raises(InitialisationError, match=r"linkage: .*stop_travel reaches"):
        outcome("flapping-no-wing", {"linkage.stop_travel": "2.3 mm"})
    with pytest.raises(InitialisationError, match=r"spring: .*no capacitance left"):
        outcome("oscillator-1", {"payload.start_displacement": "0.5"})


def test_the_same_run_twice_is_bitwise_equal(outcome: Runner) -> None:
    one = outcome("flapping-full-wings", time={"stop": "3 cycles"})
    two = outcome("flapping-full-wings", time={"stop": "3 cycles"})
    assert one.rows.tobytes() == two.rows.tobytes()


@pytest.mark.skipif(not MAPS.is_file(), reason="memory maps can be read on Linux only")
def test_runs_map_no_library_twice(outcome: Runner) -> None:
    """Libraries stay in the process for good: all runs share one copy of ours."""

    def mapped() -> int:
        outcome("oscillator-1", time={"stop": "0.1 cycles"})
        return MAPS.read_text().count("/binaries/")

    outcome("oscillator-1", time={"stop": "0.1 cycles"})
    assert mapped() == mapped()


@pytest.mark.parametrize(
    ("scenario", "absent"),
    [("flapping-no-wing", "aero"), ("flapping-frames", "aero"), ("oscillator-1", "linkage")],
)
def test_what_a_scenario_does_not_need_is_not_loaded(
    library: Path, scenario: str, absent: str
) -> None:
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from orchestrator import load, run\n"
        "run(load(sys.argv[1], None, Path(sys.argv[2]), time={'stop': '1 cycles'}))\n"
        "print([m for m in sys.modules if m.startswith(sys.argv[3] + '_')])\n"
        "print([m for m in ('xarray', 'matplotlib', 'control') if m in sys.modules], flush=True)\n"
        "import os\n"
        "os._exit(0)  # PythonFMU's library may corrupt the heap when a process ends\n"
    )
    done = subprocess.run(
        python("-c", code, scenario, library, absent),
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout.splitlines() == ["[]", "[]"]


def test_decimation(outcome: Runner) -> None:
    done = outcome("oscillator-1", time={"stop": "3 cycles"}, record={"every": 4})
    assert len(done.times) == 3 * 60 // 4 + 1
