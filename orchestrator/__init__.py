"""Co-simulation of FMUs: scenarios, instances, masters, results.

What most users need is here: :func:`load`, :func:`run`, :func:`dataset`, and :class:`Observer`
with the :class:`View` that it is given. All are imported when they are first used, so that a
command that needs none of them stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .results.netcdf import dataset
    from .simulation.load import load
    from .simulation.observers import Observer
    from .simulation.run import run
    from .simulation.view import View

__all__ = ["Observer", "View", "dataset", "load", "run"]

HOMES = {
    "Observer": "simulation.observers",
    "View": "simulation.view",
    "dataset": "results.netcdf",
    "load": "simulation.load",
    "run": "simulation.run",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    if name in HOMES:
        return getattr(import_module(f".{HOMES[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
