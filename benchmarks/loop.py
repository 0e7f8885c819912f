"""What the communication loop costs around compiled parts: in C, in Python, and the calls alone.

    python benchmarks/loop.py [SCENARIO ...]       needs `resilin build`

Each figure is the least of several runs, in microseconds a communication step. `calls` is the
compiled loop without guard, audit and recorder: the FMUs' own functions and the gathering of their
inputs. `guarded` is the compiled loop in a process beside the master's, as foreign FMUs run: its
instances note each call in memory that both see. `start` is what that process costs before its
first step, in milliseconds. All is measured one after the other.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from time import perf_counter

from orchestrator.scenario.plan import Plan
from orchestrator.simulation.compiled import drive, library
from orchestrator.simulation.guarded.run import run_guarded
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import master_class
from orchestrator.simulation.observers import Guard, Recorder
from orchestrator.simulation.run import run
from orchestrator.simulation.system import System

SCENARIOS = ("flapping-full-wings", "flapping-spring-full-wings", "oscillator-1", "dea-1")
PER_CYCLE = (20, 100)
CYCLES = 20
REPEATS = 7
NATIVE = Path("build/native")


def main(names: list[str]) -> None:
    """Measure each scenario at each step, and print a line for each."""
    if reason := library.missing():
        sys.exit(f"there is no compiled loop here: {reason}")
    print(
        f"{'scenario':30} {'per cycle':>9} {'calls':>7} {'C':>7} {'guarded':>8} {'Python':>8}"
        "  of calls  real time  start"
    )
    for name in names or SCENARIOS:
        for per_cycle in PER_CYCLE:
            time = {"stop": f"{CYCLES} cycles", "step": {"per_cycle": per_cycle}}
            plan = load(name, None, NATIVE, time=time)
            calls, compiled, python = _calls(plan), _least(plan), _least(plan, python=True)
            guarded, start = _guarded(plan)
            real = plan.grid.step / compiled
            print(
                f"{name:30} {per_cycle:9} {1e6 * calls:7.2f} {1e6 * compiled:7.2f}"
                f" {1e6 * guarded:8.2f} {1e6 * python:8.1f}  {compiled / calls:8.2f}  {real:9.0f}"
                f"  {1e3 * start:5.0f}"
            )


def _least(plan: Plan, python: bool = False) -> float:
    """Seconds a step of a whole run, guard, audit and recorder included."""
    before = os.environ.get(library.SWITCH)
    if python:
        os.environ[library.SWITCH] = "python"
    library.library.cache_clear()
    try:
        runs = [run(plan, estimate=False) for _ in range(1 if python else REPEATS)]
    finally:
        if before is None:
            os.environ.pop(library.SWITCH, None)
        library.library.cache_clear()
    return min(done.wall_time / done.steps for done in runs)


def _guarded(plan: Plan) -> tuple[float, float]:
    """Seconds a step in a process beside this one, and what remains of the call's time."""
    spent = []
    for _ in range(REPEATS):
        begun = perf_counter()
        done = run_guarded(plan, None)
        spent.append((done.wall_time / done.steps, perf_counter() - begun - done.wall_time))
    return min(step for step, _ in spent), min(start for _, start in spent)


def _calls(plan: Plan) -> float:
    """Seconds a step of the same calls with nothing watching them."""
    spent = []
    for _ in range(REPEATS):
        with System(plan) as system:
            settings = plan.scenario.master
            master = master_class(settings.kind)(system, settings)
            spent.append(drive.bare(system, master, Guard(system), Recorder(system, 1)))
    return min(spent)


if __name__ == "__main__":
    main(sys.argv[1:])
