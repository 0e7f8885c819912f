"""The scenario as one ODE, at any times: the reference of all tools."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from orchestrator.scenario.plan import Plan
from orchestrator.simulation.run import replay
from orchestrator.studies.reference.monolith import as_recorded, monolithic

from .wiring import POINTS, moving, plan_of

Rows = NDArray[np.float64]


class Reference:
    """Motion of the monolith, DOP853 at 1e-10, solved anew for every set of times.

    Some tools round their steps, so that their points lie beside those of the scenario; they
    are compared at the times that they have really stepped to.
    """

    def __init__(self, scenario: str, library: Path, cycles: float) -> None:
        self.plan: Plan = plan_of(scenario, library, "ports", POINTS, cycles)
        self.names = moving(self.plan)
        self._single = monolithic(self.plan, library)
        self._known: dict[bytes, Rows] = {}

    def at(self, times: list[float]) -> Rows:
        """One row of watched values for each time."""
        key = np.round(np.asarray(times) * 1e12).tobytes()
        if key not in self._known:
            outcome = replay(self._single, [self.plan.grid.start, *times])
            if outcome.failure is not None:
                raise outcome.failure
            exact = as_recorded(outcome, self.plan)
            self._known[key] = np.column_stack([exact.series(name)[1:] for name in self.names])
        return self._known[key]
