"""Ecos through ecospy: compiled, with its fixed-step algorithm, many steps in one call."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..case import Case
from .base import March, Method, Tool, Track, importable


def _with_tbb() -> None:
    """Load the library that ecospy needs and does not contain, from where pip puts it."""
    for folder in (Path(sys.prefix) / "lib", Path(sys.prefix) / "Library" / "bin"):
        for file in sorted(folder.glob("libtbb.so.12*")):
            with suppress(OSError):
                ctypes.CDLL(str(file), mode=ctypes.RTLD_GLOBAL)
                return


class Ecos(Tool):
    """Values are read at the points of comparison only; steps between them are one call."""

    name = "ecos"
    distribution = "ecospy"
    install = "pip install ecospy tbb"
    methods = (Method("fixed step"),)

    def missing(self) -> str:
        _with_tbb()
        return importable("ecospy")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        _with_tbb()
        from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

        EcosLib.set_log_level("off")
        with EcosSimulationStructure() as structure:
            for component in case.components:
                structure.add_model(component.name, component.path)
            for wire in case.wires:
                structure.make_real_connection(
                    f"{wire.source}::{wire.output}", f"{wire.target}::{wire.input}"
                )
            values = {f"{c.name}::{s.name}": s.value for c in case.components for s in c.starts}
            structure.add_parameter_set("scenario", values)
            with EcosSimulation(case.step, structure=structure) as simulation:
                if not simulation.init(0.0, "scenario"):
                    raise RuntimeError(f"init: {EcosLib.get_last_error()}")
                names = [f"{w.component}::{w.name}" for w in case.watched]

                def march() -> Track:
                    track = Track(calls=case.count * len(case.components))
                    for _ in range(case.count // case.every):
                        simulation.step(case.every)
                        track.times.append(simulation.get_time())
                        track.rows.append([simulation.get_real(name) for name in names])
                    return track

                yield march
