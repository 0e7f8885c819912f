"""Co-simulation of FMUs: scenarios, instances, masters, results.

The two names that most users need are here: :func:`load` and :func:`run`. Both are imported when
they are first used, so that a command that needs neither stays light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .results.netcdf import dataset
    from .simulation.load import load
    from .simulation.run import run

__all__ = ["dataset", "load", "run"]


def __getattr__(name: str) -> Any:
    if name == "load":
        from .simulation.load import load

        return load
    if name == "run":
        from .simulation.run import run

        return run
    if name == "dataset":
        from .results.netcdf import dataset

        return dataset
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
