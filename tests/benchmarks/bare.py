"""The plainest parallel master, directly on FMPy: what a Jacobi tool does, in few lines."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from peers.case import Case

ROUNDS = 8
"""Passes in initialisation mode: more than any chain of our parts is long."""


class Bare:
    """Steps all instances from the values of the last point, and reads their outputs.

    With `again` it then sets the new values and reads once more, so that outputs that follow
    inputs directly hold at the new point, and does so before the first step too, until they are
    consistent; our `jacobi` does both. Without it the values read after the step stay, as in the
    other tools; with `zeros` every wired input starts from zero, as in some of these.
    """

    def __init__(self, case: Case, *, again: bool, zeros: bool = False) -> None:
        self.case, self.again = case, again
        self.values: dict[tuple[str, int], float] = {}
        if zeros:
            self.values = dict.fromkeys(((w.source, w.output_reference) for w in case.wires), 0.0)

    def run(self) -> list[float]:
        """Watched values at the end."""
        with ExitStack() as stack:
            self.slaves = {c.name: self._opened(c, stack) for c in self.case.components}
            self._initialise()
            for k in range(self.case.count):
                for name, slave in self.slaves.items():
                    if self.values:
                        self._give(name)
                    slave.doStep(k * self.case.step, self.case.step)
                self._read()
                for name in self.slaves if self.again else ():
                    self._give(name)
                    self._read(name)
            found = []
            for w in self.case.watched:
                found.append(self.slaves[w.component].getReal([w.reference])[0])
            return found

    def _opened(self, component: Any, stack: ExitStack) -> FMU2Slave:
        folder = stack.enter_context(TemporaryDirectory(prefix="bare_"))
        extract(component.path, folder)
        description = read_model_description(component.path, validate=False)
        slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(Path(folder)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=component.name,
        )
        slave.instantiate()
        stack.callback(slave.freeInstance)
        slave.setupExperiment(startTime=0.0)
        for start in component.starts:
            slave.setReal([start.reference], [start.value])
        return slave

    def _initialise(self) -> None:
        for slave in self.slaves.values():
            slave.enterInitializationMode()
        for _ in range(ROUNDS if self.again else 0):
            for name in self.slaves:
                self._read(name)
            for name in self.slaves:
                self._give(name)
        for slave in self.slaves.values():
            slave.exitInitializationMode()
        for name in self.slaves if self.again else ():
            self._read(name)

    def _read(self, only: str = "") -> None:
        for wire in self.case.wires:
            if not only or wire.source == only:
                key = wire.source, wire.output_reference
                self.values[key] = self.slaves[wire.source].getReal([wire.output_reference])[0]

    def _give(self, name: str) -> None:
        for wire in self.case.wires:
            if wire.target == name:
                value = self.values[wire.source, wire.output_reference]
                self.slaves[name].setReal([wire.input_reference], [value])
