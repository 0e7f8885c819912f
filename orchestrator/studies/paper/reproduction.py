"""All items, or those asked for: run, gathered, reported."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

from ...errors import InputError, nearest, printable
from .animation import flight
from .beyond.controller import controller
from .beyond.electrode import electrode
from .beyond.hovering import hovering
from .beyond.membrane import membrane
from .beyond.permittivity import permittivity
from .beyond.superharmonic import superharmonic
from .cached_runs import CachedRuns
from .comparison import Comparison
from .equation6 import equation6
from .figure3 import figure3
from .figure7 import figure7
from .figure8 import figure8
from .figure9 import figure9
from .figure11 import figure11
from .figure13 import figure13
from .readings import vehicle_readings
from .table1 import table1
from .table2 import table2

COMPARISONS: dict[str, Callable[[CachedRuns], Comparison]] = {
    "figure3": figure3,
    "figure7": figure7,
    "table1": table1,
    "figure8": figure8,
    "table2": table2,
    "figure9": figure9,
    "figure11": figure11,
    "figure13": figure13,
    "equation6": equation6,
}
"""What the paper states numbers of."""

BEYOND: dict[str, Callable[[CachedRuns], Comparison]] = {
    "animation": flight,
    "readings": vehicle_readings,
    "membrane": membrane,
    "superharmonic": superharmonic,
    "electrode": electrode,
    "hovering": hovering,
    "permittivity": permittivity,
    "controller": controller,
}
"""What it does not."""

ALL = COMPARISONS | BEYOND


@dataclass(frozen=True)
class Reproduction:
    """Items, the runs made for them this time, and the seconds they took."""

    items: Sequence[Comparison]
    ran: int
    wall_time: float

    @property
    def failures(self) -> list[str]:
        """What stopped runs say, each once."""
        return list(dict.fromkeys(text for item in self.items for text in item.failures))


def chosen(names: Sequence[str]) -> list[str]:
    """The items of these names in the paper's order; all where none is named."""
    for name in names:
        if name not in ALL:
            closest = nearest(name, ALL, show=len(ALL))
            raise InputError(f"no item {printable(name)!r} of the paper; {closest}")
    return [name for name in ALL if name in names or not names]


def reproduced(names: Sequence[str], cached_runs: CachedRuns) -> Reproduction:
    """Run what the items need, each run once."""
    begun = perf_counter()
    items = [ALL[name](cached_runs) for name in chosen(names)]
    return Reproduction(items, cached_runs.ran, perf_counter() - begun)
