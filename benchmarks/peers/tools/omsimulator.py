"""OMSimulator 3 through its Python package: an SSP made in memory, its default master."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..case import Case
from .base import March, Method, Tool, Track, importable

ROOT = "default"


class OMSimulator(Tool):
    """Written from its documentation and never run: the package's set-up fetches a binary from a
    site of its own, which could not be reached."""

    name = "omsimulator"
    distribution = "OMSimulator"
    install = "pip install OMSimulator (its set-up has to reach its own site)"
    methods = (Method("default master"),)

    def missing(self) -> str:
        return importable("OMSimulator")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from OMSimulator import SSP, CRef

        system = SSP()
        for file in sorted({component.path for component in case.components}):
            system.addResource(file, new_name=f"resources/{Path(file).name}")
        for component in case.components:
            resource = f"resources/{Path(component.path).name}"
            system.addComponent(CRef(ROOT, component.name), resource)
        for wire in case.wires:
            system.addConnection(
                CRef(ROOT, wire.source, wire.output), CRef(ROOT, wire.target, wire.input)
            )
        model: Any = system.instantiate()
        for component in case.components:
            for start in component.starts:
                model.setValue(CRef(ROOT, component.name, start.name), start.value)
        model.setFixedStepSize(case.step)
        model.setStopTime(case.count * case.step)
        model.initialize()
        names = [CRef(ROOT, w.component, w.name) for w in case.watched]

        def march() -> Track:
            track = Track(calls=case.count * len(case.components))
            for k in range(1, case.count // case.every + 1):
                time = k * case.every * case.step
                model.stepUntil(time)
                track.times.append(time)
                track.rows.append([float(model.getValue(name)) for name in names])
            return track

        try:
            yield march
        finally:
            model.terminate()
            model.delete()
