"""The master's own cost: a communication step beside a bare loop of FMI calls, in one run.

`python benchmarks/overhead.py [SCENARIO ...]`. The bare loop calls set, doStep and get of the same
instances with preallocated buffers and moves nothing between them; `calls` repeats exactly
the FMI calls that the master makes, followers included. The minimum of several
repeats is shown, in microseconds per communication step and instance.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from time import perf_counter

from orchestrator.scenario.plan import Plan
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import GaussSeidel
from orchestrator.simulation.stepping import advance
from orchestrator.simulation.system import System

STEPS = 1000
REPEATS = 7
SCENARIOS = ("oscillator-1", "flapping-no-wing", "flapping-full-wings")


def bare(system: System, followers: bool) -> float:
    """Seconds for `STEPS` rounds of FMI calls."""
    instances = [coupled.instance for coupled in system.instances]
    again = [coupled.instance for coupled in system.followers] if followers else []
    step = system.plan.grid.step
    begun = perf_counter()
    for k in range(STEPS):
        time = k * step
        for instance in instances:
            instance._send()  # type: ignore[attr-defined]
            instance._do_step(instance._instance, time, step, 1)  # type: ignore[attr-defined]
            instance._receive[-1]()  # type: ignore[attr-defined]
        for instance in again:
            instance._send()  # type: ignore[attr-defined]
            instance._receive[-1]()  # type: ignore[attr-defined]
    return perf_counter() - begun


def ours(system: System) -> float:
    """Seconds for `STEPS` steps of the sequential master, nothing recorded."""
    master = GaussSeidel(system, system.plan.scenario.master)
    begun = perf_counter()
    advance(system, master, [])
    return perf_counter() - begun


def least(plan: Plan, measure: Callable[[System], float]) -> float:
    """Minimum over repeats, each on fresh instances."""
    found = []
    for _ in range(REPEATS):
        with System(plan) as system:
            found.append(measure(system))
    return min(found)


def main() -> None:
    head = f"{'scenario':22} {'FMUs':>5} {'bare':>8} {'calls':>8} {'master':>8}"
    print(f"{head}  of bare  of calls")
    for name in sys.argv[1:] or SCENARIOS:
        base = load(name)
        stop = STEPS * base.grid.step
        plan = load(name, time={"stop": stop})
        scale = 1e6 / STEPS / len(plan.order)
        plain = scale * least(plan, lambda system: bare(system, False))
        same = scale * least(plan, lambda system: bare(system, True))
        master = scale * least(plan, ours)
        print(
            f"{name:22} {len(plan.order):5} {plain:8.1f} {same:8.1f} {master:8.1f}"
            f"  {master / plain:7.2f} {master / same:8.2f}"
        )


if __name__ == "__main__":
    main()
