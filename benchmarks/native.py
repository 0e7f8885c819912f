"""Parts with Python and without, side by side in one run.

`python benchmarks/native.py [SCENARIO ...]` needs both kinds of parts: `resilin build`, `resilin
build --native`. Three tables: a step of each part alone, by the calls that a master makes (set
inputs, step, get outputs, each repeated and the least time taken); a scenario with both kinds
at steps per cycle, in seconds simulated over seconds of processor time, which a busy machine
disturbs least; the monolith's right-hand side.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance import InProcessInstance, in_process
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import GaussSeidel
from orchestrator.simulation.stepping import advance
from orchestrator.simulation.system import System

KINDS = (Path("build/fmus"), Path("build/native"))
"""Folders of the Python and of the compiled parts."""

STEPS = 200
REPEATS = 9
STEP = 1e-4
PER_CYCLE = (20, 50, 100, 200, 400)
CYCLES = 10
SCENARIOS = ("flapping-full-wings", "flapping-spring-full-wings")
EXCITED = {
    "force.value": 0.05,
    "force.stiffness": 300.0,
    "motion.displacement": 5e-4,
    "motion.velocity": 0.05,
    "motion.flap_rate": 30.0,
    "top.voltage": 1500.0,
    "bottom.voltage": 1100.0,
}


def loaded(fmu: Path, folder: Path) -> InProcessInstance:
    """An initialised instance with buffers over all real inputs and outputs."""
    extract(fmu, folder)
    interface = read_interface(fmu)
    instance = in_process(fmu.stem, interface, folder)
    instance.prepare({}, 0.0, 1.0, None)
    inputs = [v for v in interface.of("input") if v.kind == "Real"]
    outputs = interface.of("output")
    sent = np.array([EXCITED.get(v.name, float(v.start or 0.0)) for v in inputs])
    instance.connect(inputs, sent, [outputs], np.zeros(len(outputs)))
    instance.enter_initialisation()
    instance.send()
    instance.exit_initialisation()
    return instance


def calls(instance: InProcessInstance) -> dict[str, Callable[[], Any]]:
    """What is timed: a step alone, a step with its inputs and outputs, saving and restoring."""
    time = 0.0

    def step() -> None:
        nonlocal time
        instance.step(time, STEP)
        time += STEP

    def round_trip() -> None:
        instance.send()
        step()
        instance.receive()

    def rollback() -> None:
        state = instance.save()
        instance.restore(state)
        instance.forget(state)

    return {"set + step + get": round_trip, "step": step, "state": rollback}


def least(both: list[Callable[[], Any]]) -> list[float]:
    """Microseconds for a call, measured in turns so that both kinds share the machine's load."""
    found: list[list[float]] = [[] for _ in both]
    for _ in range(REPEATS):
        for times, call in zip(found, both, strict=True):
            begun = perf_counter()
            for _ in range(STEPS):
                call()
            times.append(perf_counter() - begun)
    return [1e6 * min(times) / STEPS for times in found]


def parts() -> None:
    print(f"{'part':12} {'call':18} {'Python us':>10} {'native us':>10} {'ratio':>7}")
    for fmu in sorted(KINDS[1].glob("*.fmu")):
        with tempfile.TemporaryDirectory() as folder:
            instances = []
            for kind in KINDS:
                place = Path(folder) / kind.name
                place.mkdir()
                instances.append(loaded(kind / fmu.name, place))
            slow, fast = (calls(instance) for instance in instances)
            for name in slow:
                python, native = least([slow[name], fast[name]])
                ratio = python / native
                print(f"{fmu.stem:12} {name:18} {python:10.1f} {native:10.2f} {ratio:7.1f}")
            for instance in instances:
                instance.close()


def scenarios(names: tuple[str, ...]) -> None:
    print(
        f"\n{'scenario':22} {'per cycle':>9} {'Python':>8} {'native':>8} {'ratio':>7}   times real"
    )
    for name in names:
        for count in PER_CYCLE:
            time = {"stop": f"{CYCLES} cycles", "step": {"per_cycle": count}}
            plans = [load(name, None, kind, time=time) for kind in KINDS]
            best = [0.0, 0.0]
            for _ in range(3):
                for k, plan in enumerate(plans):
                    with System(plan) as system:
                        master = GaussSeidel(system, plan.scenario.master)
                        begun = process_time()
                        advance(system, master, [])
                        passed = process_time() - begun
                    best[k] = max(best[k], (plan.grid.stop - plan.grid.start) / passed)
            python, native = best
            print(f"{name:22} {count:9} {python:8.2f} {native:8.2f} {native / python:7.1f}")


def reference() -> None:
    """Needs the source tree and a C compiler, unlike the rest."""
    from fmus.amplifier.physics import Input
    from fmus.monolith import equations, physics
    from fmus.native.reference import right_hand_side

    print(f"\n{'right-hand side':22} {'Python us':>10} {'native us':>10} {'ratio':>7}")
    for name, elasticity in (("spring", 1.0), ("membrane", 2.0)):
        p = physics.Params(elasticity=elasticity, linkage_wing_inertia=8e-8)
        state = physics.initial(p, physics.Input(), 0.0)
        y = np.array([getattr(state, field) for field in equations.FIELDS])
        made = [
            make(physics._composition(p, state), Input(), 1e-3)
            for make in (physics.right_hand_side, right_hand_side)
        ]
        made[1](0.0, y)
        python, native = least([partial(f, 1e-3, y) for f in made])
        print(f"{name:22} {python:10.1f} {native:10.2f} {python / native:7.1f}")


def main() -> None:
    parts()
    scenarios(tuple(sys.argv[1:]) or SCENARIOS)
    reference()


if __name__ == "__main__":
    main()
