"""Prey and predators as two FMUs that exchange one number each, by step control."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.scenarios import Shelf, populations

OTHERS_CALLS = 3 * 8872
"""Step calls of step doubling in another tool at a tolerance of 1e-6."""
NAMES = ("prey.size", "predators.size")


def controlled(folder: Path, shelf: Shelf, tolerance: float) -> Outcome:
    """A run by a tolerance alone: no step, no frequency."""
    path = populations(folder, shelf, more=f"tolerance = {tolerance}")
    text = path.read_text()
    path.write_text("\n".join(line for line in text.split("\n") if not line.startswith("step =")))
    return run(load(path), estimate=True).checked()


def true_error(done: Outcome) -> float:
    """Largest error of both populations, by their largest values, against an ODE solver."""

    def rates(_: float, sizes: np.ndarray) -> list[float]:
        prey, predators = sizes
        return [(1.5 - predators) * prey, (prey - 3.0) * predators]

    exact = solve_ivp(
        rates, (0.0, 15.0), [10.0, 5.0], "DOP853", done.times, rtol=1e-12, atol=1e-12
    ).y
    misses = [np.abs(done.series(n) - y).max() / y.max() for n, y in zip(NAMES, exact, strict=True)]
    return float(max(misses))


@pytest.mark.parametrize(
    ("tolerance", "calls", "error"), [(1e-4, 700, 2e-2), (1e-6, 1500, 1e-3), (1e-8, 3500, 4e-5)]
)
def test_a_tolerance_costs_few_steps_and_its_error_is_estimated(
    shelf: Shelf, tmp_path: Path, tolerance: float, calls: int, error: float
) -> None:
    done = controlled(tmp_path, shelf, tolerance)
    assert max(done.calls.values()) < min(calls, OTHERS_CALLS)
    true = true_error(done)
    assert true < error
    assert done.estimates is not None
    estimated = max(done.estimates[name].relative for name in NAMES)
    assert 1.0 / 3.0 < estimated / true < 3.0
