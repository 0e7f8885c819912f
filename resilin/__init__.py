"""Resilin from Python: load a scenario, run it, sweep it, look at the result.

    from resilin import load, run

    result = run(load("flapping-full-wings", {"amplifier.frequency": "20 Hz"}))
    angle = result.series("linkage.flap_angle")

:func:`load` checks a scenario and gives a :class:`Plan`; :func:`run` steps it and gives a
:class:`Result`; :func:`metrics` and :func:`dataset` (an `xarray.Dataset`) are made of a result;
:func:`sweep` runs a scenario over a grid; :func:`parts` gives the built parts with what can be set
on them. An :class:`Observer` watches a run through a :class:`View`. Whatever a user may get wrong
raises a :class:`ResilinError` that names the thing, the place and the way out.
"""

from orchestrator import (
    Observer,
    Plan,
    View,
    dataset,
    load,
    metrics,
    parts,
    run,
    sweep,
)
from orchestrator import Outcome as Result
from orchestrator.errors import ResilinError
from orchestrator.results.netcdf import release

__version__ = release()

__all__ = [
    "Observer",
    "Plan",
    "ResilinError",
    "Result",
    "View",
    "dataset",
    "load",
    "metrics",
    "parts",
    "run",
    "sweep",
]
