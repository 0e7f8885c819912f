"""What an observer sees of a run: the time and the values that hold there, to be read only."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from ..errors import nearest
from .system import System


class View(Mapping[str, float]):
    """A run at one communication point: `view["linkage.flap_angle"]`, in SI.

    A mapping of `component.variable` to the value that holds at `time` [s]. It has all outputs
    that are wired or recorded, in the order of :attr:`names`. `step` counts communication points
    from 0 at the start; where a tolerance chooses the steps it may skip numbers.

    One view serves a whole run: `time`, `step` and the values are those of the present
    communication point. Numbers taken out of it are copies, which may be kept.
    """

    def __init__(self, system: System) -> None:
        self._values = system.values
        self._places = {name: place for place, name in enumerate(system.names)}
        self._time = system.plan.grid.start
        self._step = 0

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._time

    @property
    def step(self) -> int:
        """Number of the communication point, 0 at the start."""
        return self._step

    @property
    def names(self) -> tuple[str, ...]:
        """All names, in the order of `array`."""
        return tuple(self._places)

    def array(self) -> NDArray[np.float64]:
        """A copy of all values, in the order of `names`."""
        return self._values.copy()

    def __getitem__(self, name: str) -> float:
        try:
            return float(self._values[self._places[name]])
        except KeyError:
            hint = nearest(str(name), self._places)
            raise KeyError(f"no wired or recorded output {name!r}; {hint}") from None

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __repr__(self) -> str:
        return f"<View of {len(self)} values at t = {self._time:.9g} s>"

    def _move(self, step: int, time: float) -> None:
        """Go on to the next communication point; called by the run alone."""
        self._step, self._time = step, time
