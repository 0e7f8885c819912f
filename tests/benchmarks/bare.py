"""The plainest parallel master, straight over FMPy: what a Jacobi tool does, in thirty lines."""

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
    """Steps all units from the values of the last point, and reads what they put out.

    With `again` it then hands the new values over and reads once more, so that outputs that
    follow inputs directly hold at the new point, and settles them before the first step; our
    `jacobi` does both. Without, what was read during the step stays, as in the other tools; `zeros`
    are what some of these start every wired input with.
    """

    def __init__(self, case: Case, *, again: bool, zeros: bool = False) -> None:
        self.case, self.again = case, again
        self.values: dict[tuple[str, int], float] = {}
        if zeros:
            self.values = dict.fromkeys(((w.source, w.output_reference) for w in case.wires), 0.0)

    def run(self) -> list[float]:
        """Watched values at the end."""
        with ExitStack() as stack:
            self.units = {c.name: self._opened(c, stack) for c in self.case.components}
            self._initialise()
            for k in range(self.case.count):
                for name, unit in self.units.items():
                    if self.values:
                        self._give(name)
                    unit.doStep(k * self.case.step, self.case.step)
                self._read()
                for name in self.units if self.again else ():
                    self._give(name)
                    self._read(name)
            found = []
            for w in self.case.watched:
                found.append(self.units[w.component].getReal([w.reference])[0])
            return found

    def _opened(self, component: Any, stack: ExitStack) -> FMU2Slave:
        folder = stack.enter_context(TemporaryDirectory(prefix="bare_"))
        extract(component.path, folder)
        said = read_model_description(component.path, validate=False)
        unit = FMU2Slave(
            guid=said.guid,
            unzipDirectory=str(Path(folder)),
            modelIdentifier=said.coSimulation.modelIdentifier,
            instanceName=component.name,
        )
        unit.instantiate()
        stack.callback(unit.freeInstance)
        unit.setupExperiment(startTime=0.0)
        for start in component.starts:
            unit.setReal([start.reference], [start.value])
        return unit

    def _initialise(self) -> None:
        for unit in self.units.values():
            unit.enterInitializationMode()
        for _ in range(ROUNDS if self.again else 0):
            for name in self.units:
                self._read(name)
            for name in self.units:
                self._give(name)
        for unit in self.units.values():
            unit.exitInitializationMode()
        for name in self.units if self.again else ():
            self._read(name)

    def _read(self, only: str = "") -> None:
        for wire in self.case.wires:
            if not only or wire.source == only:
                key = wire.source, wire.output_reference
                self.values[key] = self.units[wire.source].getReal([wire.output_reference])[0]

    def _give(self, name: str) -> None:
        for wire in self.case.wires:
            if wire.target == name:
                value = self.values[wire.source, wire.output_reference]
                self.units[name].setReal([wire.input_reference], [value])
