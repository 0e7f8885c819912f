"""PathSim with its FMI toolbox: each FMU a block that a scheduled event steps."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from ..case import Case
from .base import March, Method, Tool, Track, importable


class Pathsim(Tool):
    """A block steps at the beginning of its interval, in the order of the blocks, and its new
    outputs are visible at once: sequential, and one step ahead of PathSim's own time, which is
    corrected here. Inputs that are not wired are zero and not their FMU's start value, which works
    with our parts. Values are read by a recorder that PathSim samples itself. Blocks free their
    instances when they are deleted."""

    name = "pathsim-fmi"
    distribution = "pathsim-fmi"
    install = "pip install pathsim-fmi"
    methods = (Method("fixed step"),)

    def missing(self) -> str:
        return importable("pathsim", "pathsim_fmi.blocks")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from pathsim import Connection, Simulation
        from pathsim.blocks import Scope
        from pathsim_fmi import CoSimulationFMU

        blocks = {
            c.name: CoSimulationFMU(
                c.path, c.name, {s.name: s.value for s in c.starts}, dt=case.step
            )
            for c in case.components
        }
        scope = Scope()
        connections = [
            Connection(blocks[w.source][w.output], blocks[w.target][w.input]) for w in case.wires
        ]
        connections += [
            Connection(blocks[w.component][w.name], scope[k]) for k, w in enumerate(case.watched)
        ]
        simulation = Simulation([*blocks.values(), scope], connections, dt=case.step, log=False)

        def march() -> Track:
            simulation.run((case.count - 1) * case.step)
            times, columns = scope.read()
            kept = range(case.every - 1, len(times), case.every)
            return Track(
                [float(times[k]) + case.step for k in kept],
                [[float(column[k]) for column in columns] for k in kept],
                len(times) * len(blocks),
            )

        yield march
