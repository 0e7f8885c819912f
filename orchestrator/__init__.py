"""Co-simulation of FMUs: scenarios, instances, masters, results.

What most programs need is here, and in the package `resilin`, which is nothing but these names. All
are imported when they are first used, so that a command that needs none of them stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .results.metrics import metrics
    from .results.netcdf import dataset
    from .results.outcome import Outcome
    from .scenario.part_inspection import parts
    from .scenario.plan import Plan
    from .simulation.load import load
    from .simulation.observers import Observer
    from .simulation.run import run
    from .simulation.view import View
    from .studies.sweep.study import sweep

__all__ = [
    "Observer",
    "Outcome",
    "Plan",
    "View",
    "dataset",
    "load",
    "metrics",
    "parts",
    "run",
    "sweep",
]

HOMES = {
    "Observer": "simulation.observers",
    "Outcome": "results.outcome",
    "Plan": "scenario.plan",
    "View": "simulation.view",
    "dataset": "results.netcdf",
    "load": "simulation.load",
    "metrics": "results.metrics",
    "parts": "scenario.part_inspection",
    "run": "simulation.run",
    "sweep": "studies.sweep.study",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    if name in HOMES:
        return getattr(import_module(f".{HOMES[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
