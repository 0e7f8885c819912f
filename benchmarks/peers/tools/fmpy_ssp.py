"""FMPy's `simulate_ssp`: all components take the outputs of the others one step before."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

from ..case import Case
from ..ssp import Parameters, write_ssp
from .base import March, Method, Tool, Track, importable


class FmpySsp(Tool):
    """Inputs are 0.0 in the first step, whatever their FMUs' start values. One function unpacks,
    instantiates, runs and frees: time is measured from the first step of a component to the end
    of the last. It stamps values after a step with the time before it, which is corrected here,
    and adds up its time in floating point."""

    name = "fmpy.ssp"
    distribution = "fmpy"
    install = "pip install fmpy"
    methods = (Method("jacobi"),)

    def missing(self) -> str:
        return importable("fmpy.ssp.simulation")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from fmpy.ssp import simulation

        plain = simulation.do_step
        with tempfile.TemporaryDirectory(prefix="peers_") as folder:
            path = Path(folder) / "system.ssp"
            write_ssp(case, path)
            stop = (case.count - 0.5) * case.step
            steps = _Steps(plain)

            def march() -> Track:
                begun = perf_counter()
                table = simulation.simulate_ssp(
                    str(path), 0.0, stop, case.step, parameter_set=Parameters(case)
                )
                names = [f"{w.component}.{w.name}" for w in case.watched]
                kept = range(case.every - 1, len(table), case.every)
                return Track(
                    [float(table["time"][k]) + case.step for k in kept],
                    [[float(table[name][k]) for name in names] for k in kept],
                    len(table) * len(case.components),
                    perf_counter() - begun - (steps.last - steps.first),
                )

            simulation.do_step = steps
            try:
                yield march
            finally:
                simulation.do_step = plain


class _Steps:
    """FMPy's own step of a component, and the clock read around it."""

    def __init__(self, plain: Callable[[Any, float, float], None]) -> None:
        self._plain = plain
        self.first = self.last = 0.0

    def __call__(self, component: Any, time: float, size: float) -> None:
        self.first = self.first or perf_counter()
        self._plain(component, time, size)
        self.last = perf_counter()
