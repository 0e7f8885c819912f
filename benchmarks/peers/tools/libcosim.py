"""libcosim through libcosimpy: compiled; its fixed-step algorithm and ECCO."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

from ..case import Case
from .base import March, Method, Tool, Track, importable

NANO = 1e9
MOST = 4_000_000
"""Samples that are kept of a run whose number of steps is not known in advance."""


class Libcosim(Tool):
    """Steps are whole nanoseconds, so that its points deviate by up to half a nanosecond per step
    from the scenario's: times are those to which it has really stepped. It records the watched
    values itself; reading them afterwards is not timed. Instances are initialised in the first
    step, which is therefore taken before the measured time begins. ECCO chooses its steps from the
    energy residual of the power bonds, to the tolerance of the run."""

    name = "libcosim"
    distribution = "libcosimpy"
    install = "pip install libcosimpy"
    methods = (Method("fixed step"), Method("ecco", ("values",), "tolerance", 1.0))

    def missing(self) -> str:
        return importable("libcosimpy.CosimExecution")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from libcosimpy._internal import get_last_error_message
        from libcosimpy.CosimEnums import CosimVariableType
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimObserver import CosimObserver

        log_output_level(CosimLogLevel.ERROR)
        adaptive = method == "ecco"
        algorithm = _ecco(case) if adaptive else None
        if algorithm is None:
            execution = CosimExecution.from_step_size(round(case.step * NANO))
        else:
            execution = CosimExecution.from_algorithm(algorithm)
        places = _components(case, execution)
        for wire in case.wires:
            execution.connect_real_variables(
                places[wire.source], wire.output_reference,
                places[wire.target], wire.input_reference,
            )  # fmt: skip
        if algorithm is not None:
            _bonds(case, algorithm, places)
        real = CosimVariableType.REAL
        most = MOST if adaptive else case.count + 2
        observer = CosimObserver.create_time_series(most)
        execution.add_observer(observer)
        for w in case.watched:
            observer.start_time_series(places[w.component], w.reference, real)
        # variables of ECCO's bonds have to be observed: it reads them nowhere else
        for place in (place for bond in case.bonds for place in bond if adaptive):
            wire = case.wires[place]
            observer.start_time_series(places[wire.source], wire.output_reference, real)
            observer.start_time_series(places[wire.target], wire.input_reference, real)
        execution.real_time_simulation_enabled(False)
        if not execution.step(1):
            raise RuntimeError(get_last_error_message())

        def march() -> Track:
            if adaptive:
                good = execution.simulate_until(round(case.count * case.step * NANO))
            else:
                good = execution.step(case.count - 1)
            if not good:
                raise RuntimeError(get_last_error_message())
            begun = perf_counter()
            columns: list[list[float]] = []
            times: list[float] = []
            for w in case.watched:
                stamps, steps, values = observer.time_series_real_samples(
                    places[w.component], w.reference, from_step=1, sample_count=most
                )
                kept = [k for k, t in enumerate(stamps) if t > 0]
                if not adaptive:
                    kept = [k for k in kept if steps[k] % case.every == 0]
                times = [stamps[k] / NANO for k in kept]
                columns.append([values[k] for k in kept])
            rows = [list(row) for row in zip(*columns, strict=True)]
            count = len(times) if adaptive else case.count
            aside = perf_counter() - begun
            return Track(times, rows, count * len(case.components), aside)

        yield march


def _components(case: Case, execution: Any) -> dict[str, int]:
    from libcosimpy.CosimSlave import CosimLocalSlave

    places = {}
    for component in case.components:
        slave = CosimLocalSlave(component.path, component.name)
        places[component.name] = execution.add_local_slave(slave)
        for start in component.starts:
            execution.real_initial_value(places[component.name], start.reference, start.value)
    return places


def _ecco(case: Case) -> Any:
    """The algorithm with its own defaults, but for steps and tolerances."""
    from libcosimpy.CosimAlgorithm import CosimAlgorithm, EccoParams

    cycle = case.step * case.per_cycle
    return CosimAlgorithm.create_ecco_algorithm(
        EccoParams(
            step_size=cycle / 1000, min_step_size=cycle / 100_000, max_step_size=cycle / 20,
            min_change_rate=0.2, max_change_rate=1.5,
            abs_tolerance=case.rtol * 1e-6, rel_tolerance=case.rtol,
        )
    )  # fmt: skip


def _bonds(case: Case, algorithm: Any, places: dict[str, int]) -> None:
    for effort, flow in case.bonds:
        there, back = case.wires[effort], case.wires[flow]
        algorithm.add_power_bond(
            places[there.source], there.output_reference, back.input_reference,
            places[back.source], back.output_reference, there.input_reference,
        )  # fmt: skip
