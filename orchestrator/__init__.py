"""Co-simulation of FMUs: scenes, units, masters, results.

The two names that most users need are here: :func:`load` and :func:`run`. Both are imported when
they are first used, so that a command that needs neither stays light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .results import dataset
    from .simulation import load, run

__all__ = ["dataset", "load", "run"]


def __getattr__(name: str) -> Any:
    if name in {"load", "run"}:
        from . import simulation

        return getattr(simulation, name)
    if name == "dataset":
        from .results import dataset

        return dataset
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
