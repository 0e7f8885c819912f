"""Error against run time of the laws, on any scenario made of Resilin's parts.

    python benchmarks/coupling.py flapping-full-wings --cycles 20

One table: for each way of using the ports (curvature, affine, held) and each number of steps
per cycle the largest relative error of the recorded motion against the monolith, the
observed order, wall time (least of the repeats, without loading), times real time, and
the share of the time spent outside FMI calls.
"""

from __future__ import annotations

import math
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from orchestrator.fmi import instance
from orchestrator.results.outcome import Outcome
from orchestrator.scenario.library import LIBRARY
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.reference.monolith import as_recorded, monolithic

BASE = 10
"""Points per cycle at which solutions are compared; every number of steps is a multiple."""

MOTIONS = ("displacement", "flap_angle")


class FmiClock:
    """Time spent inside FMI calls, by wrapping the three calls of the stepping path."""

    def __init__(self) -> None:
        self.spent = 0.0
        self._own = {name: getattr(instance.Instance, name) for name in ("send", "step", "receive")}

    def __enter__(self) -> FmiClock:
        for name, function in self._own.items():
            setattr(instance.Instance, name, self._timed(function))
        return self

    def __exit__(self, *exception: object) -> None:
        for name, function in self._own.items():
            setattr(instance.Instance, name, function)

    def _timed(self, function: Any) -> Any:
        def timed(*arguments: Any) -> None:
            begun = perf_counter()
            function(*arguments)
            self.spent += perf_counter() - begun

        return timed


def solve(
    scenario: str, laws: str, steps: int, cycles: int, library: Path, repeats: int
) -> tuple[Outcome, float]:
    """Outcome with the least wall time of some repeats, and that time [s]."""
    time = {"step": {"per_cycle": steps}, "stop": f"{cycles} cycles"}
    plan = load(scenario, None, library, master={"laws": laws}, time=time)
    outcomes = [run(plan, estimate=False) for _ in range(repeats)]
    best = min(outcomes, key=lambda outcome: outcome.wall_time)
    return best, best.wall_time


def error(outcome: Outcome, reference: Outcome, name: str, every: int) -> float:
    """Largest deviation over largest value, at the points of the reference."""
    if outcome.failure is not None:
        return math.nan
    exact = reference.series(name)
    return float(np.abs(outcome.series(name)[::every] - exact).max() / np.abs(exact).max())


def main(
    scenario: Annotated[str, typer.Argument()] = "flapping-full-wings",
    cycles: Annotated[int, typer.Option()] = 20,
    repeats: Annotated[int, typer.Option()] = 3,
    steps: Annotated[str, typer.Option()] = "20,50,60,100,200,400",
    library: Annotated[Path, typer.Option()] = LIBRARY,
) -> None:
    """Print the table."""
    time = {"step": {"per_cycle": BASE}, "stop": f"{cycles} cycles"}
    base = load(scenario, None, library, time=time)
    begun = perf_counter()
    reference = as_recorded(run(monolithic(base, library), estimate=False), base)
    spent = perf_counter() - begun
    moving = [n for n in reference.names if n.rpartition(".")[2] in MOTIONS]
    simulated = base.grid.stop - base.grid.start
    title = f"{scenario}, {cycles} cycles; reference in {spent:.1f} s"
    table = Table(
        "laws", "steps/cycle", *moving, "order", "wall s", "x real time", "outside FMI", title=title
    )
    for laws in ("curvature", "affine", "held"):
        before: tuple[int, float] | None = None
        for count in (int(text) for text in steps.split(",")):
            outcome, wall = solve(scenario, laws, count, cycles, library, repeats)
            errors = [error(outcome, reference, name, count // BASE) for name in moving]
            order = ""
            if before is not None and errors[0] > 0.0:
                order = f"{math.log(before[1] / errors[0]) / math.log(count / before[0]):.2f}"
            with FmiClock() as clock:
                timed, _ = solve(scenario, laws, count, cycles, library, 1)
            outside = 1.0 - clock.spent / timed.wall_time
            table.add_row(
                laws,
                str(count),
                *(f"{e:.2e}" for e in errors),
                order,
                f"{wall:.3f}",
                f"{simulated / wall:.2f}",
                f"{100 * outside:.0f} %",
            )
            before = (count, errors[0])
    Console(width=120).print(table)


if __name__ == "__main__":
    typer.run(main)
