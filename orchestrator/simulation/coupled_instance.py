"""An instance in its place in a system: how its inputs are gathered and its outputs are read."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..fmi.instance import Instance
from ..scenario.connections import Connection

Values = NDArray[np.float64]
Indices = NDArray[np.intp]


class CoupledInstance:
    """An instance with its stretch of the system's values and the sources of its inputs.

    `buffer` holds all inputs that are sent to the instance: first the wired ones (`inputs`, from
    the places `sources` of the system's values), then the held ones (`held`: name to place).
    `arriving` are the connections behind the wired ones. `plain` are those wired inputs that
    arrive as bare real numbers, without a law, and may be held at a mean over a step; one that
    `decides`, that puts out nothing but switches, gets them as they are; `rising` says which of
    them may change evenly over the step. `direct` is true where an
    output in use follows an input without a step between.
    """

    def __init__(
        self, instance: Instance, values: Values, stretch: slice, arriving: list[Connection],
        sources: Indices, held: dict[str, float], decides: bool = False,
    ) -> None:  # fmt: skip
        self.instance = instance
        self.sources = sources
        self.arriving = arriving
        self.stretch = stretch
        count = len(arriving)
        self.buffer = np.zeros(count + len(held))
        self.inputs = self.buffer[:count]
        self.held = {name: count + k for k, name in enumerate(held)}
        self.buffer[count:] = list(held.values())
        self.direct = False
        self.decides = decides
        self.plain = _plain([] if decides else arriving)
        self.rising = np.array(
            [instance.interpolates and arriving[k].input.rises for k in self.plain], dtype=bool
        )
        self._values = values
        self.moves = _moves(self.inputs, values, sources)
        self._gain: Values | None = None
        self._offset: Values | None = None
        if any(c.gain != 1.0 or c.offset != 0.0 for c in arriving):
            self._gain = np.array([c.gain for c in arriving])
            self._offset = np.array([c.offset for c in arriving])

    @property
    def scaling(self) -> tuple[Values, Values] | None:
        """Gains and offsets of the wired inputs; None where none has any."""
        if self._gain is None or self._offset is None:
            return None
        return self._gain, self._offset

    def gather(self) -> None:
        """Bring the inputs up to date with the outputs of the others, and send them."""
        for target, source in self.moves:
            target[:] = source
        self._send()

    def gather_from(self, arriving: Values) -> None:
        """Send these wired values, given as their sources put them out."""
        self.inputs[:] = arriving
        self._send()

    def incline(self, rates: Values) -> None:
        """Let the plain inputs rise by these rates [1/s] of their sources over the coming step."""
        every = np.zeros(len(self.buffer))
        every[self.plain] = rates
        if self._gain is not None:
            every[: len(self._gain)] *= self._gain
        self.instance.incline(every)

    def _send(self) -> None:
        if self._gain is not None and self._offset is not None:
            np.multiply(self.inputs, self._gain, out=self.inputs)
            np.add(self.inputs, self._offset, out=self.inputs)
        self.instance.send()

    def advance(self, time: float, size: float) -> None:
        """Gather, step, and read what instances later in the execution order need."""
        self.gather()
        self.instance.step(time, size)
        self.instance.receive(0)

    def follow(self) -> None:
        """Gather and read all outputs, without a step: outputs that follow inputs directly."""
        self.gather()
        self.instance.receive()


def _plain(arriving: list[Connection]) -> Indices:
    """Places of the wired inputs that arrive as bare real numbers.

    An input belongs to a law where any member of its port that is wired with it has an order
    above zero.
    """
    laws = {c.input.port for c in arriving if c.input.port and c.input.order > 0}
    real = [c.input.real and c.output.real for c in arriving]
    found = [k for k, c in enumerate(arriving) if real[k] and c.input.port not in laws]
    return np.array(found, dtype=np.intp)


def _moves(inputs: Values, values: Values, sources: Indices) -> list[tuple[Values, Values]]:
    """Slice pairs, one for each run of neighbouring outputs."""
    moves = []
    start = 0
    for k in range(1, len(sources) + 1):
        if k == len(sources) or sources[k] != sources[k - 1] + 1:
            low = sources[start]
            moves.append((inputs[start:k], values[low : low + k - start]))
            start = k
    return moves
