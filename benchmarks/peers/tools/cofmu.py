"""CoFMPy: its default master by both methods, through the coordinator's step."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..case import Case
from .base import March, Method, Tool, Track, importable

METHODS = {"jacobi": "jacobi", "gauss-seidel": "gauss_seidel"}


class Cofmu(Tool):
    """Inputs start from zero, whatever their FMU's start values. Instances of a loop would be
    stepped in the order of a set, which changes from process to process: here they are in the order
    of the scenario. The tool keeps all outputs at every step; the watched ones are read there."""

    name = "cofmpy"
    distribution = "cofmupy"
    install = "pip install cofmupy (pins fmpy: an environment of its own, --python cofmpy=...)"
    methods = (Method("jacobi"), Method("gauss-seidel"))

    def missing(self) -> str:
        return importable("cofmupy")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from cofmupy import Coordinator

        coordinator = Coordinator()
        with contextlib.redirect_stdout(io.StringIO()):
            coordinator.start(_configuration(case, METHODS[method]))
        names = [component.name for component in case.components]
        master = coordinator.master
        master.sequence_order = [sorted(g, key=names.index) for g in master.sequence_order]

        def march() -> Track:
            for _ in range(case.count):
                coordinator.do_step(case.step)
            results = coordinator.get_results()
            columns = [results[w.component, w.name] for w in case.watched]
            kept = range(case.every - 1, case.count, case.every)
            return Track(
                [(k + 1) * case.step for k in kept],
                [[float(column[k]) for column in columns] for k in kept],
                case.count * len(case.components),
            )

        yield march


def _configuration(case: Case, method: str) -> dict[str, Any]:
    return {
        "root": "",
        "edge_sep": " -> ",
        "cosim_method": method,
        "iterative": False,
        "fmus": [
            {
                "id": c.name,
                "name": c.name,
                "path": c.path,
                "initialization": {s.name: s.value for s in c.starts},
            }
            for c in case.components
        ],
        "connections": [
            {
                "source": {"type": "fmu", "id": w.source, "variable": w.output, "unit": ""},
                "target": {"type": "fmu", "id": w.target, "variable": w.input, "unit": ""},
            }
            for w in case.wires
        ],
        "data_storages": [],
    }
