"""Runs to a tolerance: the estimated error against the monolith's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestrator.simulation.load import load
from orchestrator.simulation.run import replay, run
from orchestrator.studies.reference.monolith import as_recorded, monolithic

SCENARIOS = {
    "oscillator-1": "payload.displacement",
    "flapping-spring-full-wings": "linkage.displacement",
    "flapping-full-wings": "linkage.displacement",
}
ON_A_SPRING = ["oscillator-1", "flapping-spring-full-wings"]
FAST = [1e-2, 1e-3, 1e-4]
FINE = [1e-5, 1e-6]


def ratio(library: Path, scenario: str, tolerance: float) -> tuple[float, float]:
    """Estimated by true error of the motion, and the true one by the largest displacement."""
    plan = load(scenario, None, library, time={"stop": "8 cycles", "tolerance": tolerance})
    done = run(plan, estimate=True)
    assert done.failure is None
    assert done.estimates is not None
    single = monolithic(plan, library)
    time = single.scenario.time.model_copy(update={"tolerance": None})
    single = replace(single, scenario=single.scenario.model_copy(update={"time": time}))
    reference = as_recorded(replay(single, done.times.tolist()), plan).series(SCENARIOS[scenario])
    true = float(np.abs(done.series(SCENARIOS[scenario]) - reference).max())
    return done.estimates[SCENARIOS[scenario]].error / true, true / float(np.abs(reference).max())


@pytest.mark.parametrize("scenario", ON_A_SPRING)
@pytest.mark.parametrize("tolerance", FAST)
def test_estimate_within_a_factor_of_three(library: Path, scenario: str, tolerance: float) -> None:
    found, true = ratio(library, scenario, tolerance)
    assert 1.0 / 3.0 < found < 3.0
    assert true < 2.0 * tolerance


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", FAST)
def test_the_film_within_a_factor_of_three(library: Path, tolerance: float) -> None:
    """The film in Python takes a minute a run, so its turn is among the slow ones."""
    found, true = ratio(library, "flapping-full-wings", tolerance)
    assert 1.0 / 3.0 < found < 3.0
    assert true < 2.0 * tolerance


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ON_A_SPRING)
@pytest.mark.parametrize("tolerance", FINE)
def test_fine_tolerances_too(library: Path, scenario: str, tolerance: float) -> None:
    found, true = ratio(library, scenario, tolerance)
    assert 1.0 / 3.0 < found < 3.0
    assert true < 2.0 * tolerance


def test_steps_end_at_discontinuities(library: Path) -> None:
    """Every edge of a square wave is a communication point of an adaptive run."""
    plan = load("oscillator-1", None, library, time={"stop": "4 cycles", "tolerance": 1e-3})
    assert plan.frequency is not None
    waveform = {"amplifier.waveform": "square"}
    plan = load("oscillator-1", waveform, library, time={"stop": "4 cycles", "tolerance": 1e-3})
    done = run(plan, estimate=True)
    edges = np.arange(1, 8) * 0.5 / plan.frequency
    points = np.asarray(done.points)
    assert np.abs(points[:, None] - edges[None, :]).min(axis=0).max() < 1e-9


def test_a_fixed_step_run_can_be_estimated_too(library: Path) -> None:
    plan = load("oscillator-1", None, library, time={"stop": "5 cycles"})
    done = run(plan, estimate=True)
    assert done.estimates is not None
    assert 0.0 < done.estimates["payload.displacement"].relative < 1e-2
    assert run(plan).estimates is None
