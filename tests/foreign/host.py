"""A plain host for one foreign FMU: variables by name, steps through fmpy."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave

Logger = Callable[[int, bytes], None]
FMI_3 = {"Enumeration": "Int64"}
FMI_2 = {"Enumeration": "Integer"}


class Host:
    """One instance, with its modelDescription."""

    def __init__(self, folder: Path, logger: Logger) -> None:
        self.description: Any = fmpy.read_model_description(str(folder), validate=False)
        self.version = int(self.description.fmiVersion[0])
        self.variables: dict[str, Any] = {v.name: v for v in self.description.modelVariables}
        self.time = 0.0
        slave = FMU2Slave if self.version == 2 else FMU3Slave
        self.slave: Any = slave(
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=str(folder),
            instanceName="stranger",
        )
        if self.version == 2:
            self.callbacks = fmi2CallbackFunctions()
            self.callbacks.logger = fmi2CallbackLoggerTYPE(lambda _, __, s, ___, m: logger(s, m))
            self.callbacks.allocateMemory = defaultCallbacks.allocateMemory
            self.callbacks.freeMemory = defaultCallbacks.freeMemory
            self.slave.instantiate(callbacks=self.callbacks)
        else:
            self.slave.instantiate(logMessage=lambda _, s, __, m: logger(s, m))

    def start(self, **values: Any) -> None:
        """Set start values and initialise at the time 0."""
        for name, value in values.items():
            self.set(name, value)
        if self.version == 2:
            self.slave.setupExperiment(startTime=0.0)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=0.0)
        self.slave.exitInitializationMode()

    def step(self, size: float) -> Any:
        """One step; in FMI 3 what doStep reports."""
        report = self.slave.doStep(self.time, size)
        self.time = self.time + size if self.version == 2 else report[3]
        return report

    def get(self, name: str) -> Any:
        """Value of a variable: a scalar, or the elements of an array."""
        variable = self.variables[name]
        get = getattr(self.slave, f"get{self._kind(variable)}")
        if not variable.shape:
            return get([variable.valueReference])[0]
        count = 1
        for size in variable.shape:
            count *= size
        return get([variable.valueReference], nValues=count)

    def set(self, name: str, value: Any) -> None:
        """Set a scalar, or an array from its elements."""
        variable = self.variables[name]
        values = value if isinstance(value, list) else [value]
        getattr(self.slave, f"set{self._kind(variable)}")([variable.valueReference], values)

    def everything(self) -> dict[str, Any]:
        """Values of all variables."""
        return {name: self.get(name) for name in self.variables}

    def _kind(self, variable: Any) -> str:
        kinds = FMI_2 if self.version == 2 else FMI_3
        return str(kinds.get(variable.type, variable.type))


@contextmanager
def hosted(fmu: Path, logger: Logger = lambda status, message: None) -> Iterator[Host]:
    """An instance of an FMU, terminated and freed at the end."""
    with tempfile.TemporaryDirectory() as folder:
        fmpy.extract(str(fmu), unzipdir=folder)
        host = Host(Path(folder), logger)
        try:
            yield host
            host.slave.terminate()
        finally:
            host.slave.freeInstance()


__all__ = ["FMICallException", "Host", "Logger", "hosted"]
