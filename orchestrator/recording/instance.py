"""An instance that replays a recording: no inputs, no parameters, outputs by time alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import InstanceFailure
from ..fmi.description import Variable
from ..fmi.instance.base import Instance, Values
from .recording import Recording


class RecordingInstance(Instance):
    """A recording in the place of an FMU; its state is its time.

    Stepping past the end of the record, or starting before it, is an `InstanceFailure` unless the
    scenario sets `after` or `before` to "hold" or "zero".
    """

    def __init__(self, name: str, recording: Recording) -> None:
        super().__init__(name, recording.interface)
        self._recording = recording
        self._time = 0.0
        self._size = 0.0

    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        """Take the time at which the run starts."""
        del start, stop, tolerance
        self._set_time(time, 0.0)

    def connect(
        self,
        inputs: list[Variable],
        input_values: Values,
        outputs: list[list[Variable]],
        output_values: Values,
    ) -> None:
        """Bind the outputs; a recording has no inputs."""
        del inputs, input_values
        place = {name: k for k, name in enumerate(self.interface.variables)}
        names = [variable.name for group in outputs for variable in group]
        self._places = np.array([place[name] for name in names], dtype=np.intp)
        self._ends = np.cumsum([len(group) for group in outputs]).tolist()
        self._output = output_values

    def read_whole_at_once(self) -> None:
        """Every `receive` fills the whole buffer."""
        self._ends = [self._ends[-1]] * len(self._ends)

    def enter_initialisation(self) -> None:
        """Nothing to do."""

    def exit_initialisation(self) -> None:
        """Nothing to do."""

    def send(self) -> None:
        """Nothing to do: a recording has no inputs."""

    def step(self, time: float, size: float) -> None:
        """Advance the time."""
        self.steps += 1
        self._set_time(time + size, size)

    def _set_time(self, time: float, size: float) -> None:
        if reason := self._recording.refusal(time):
            raise InstanceFailure(f"{self.name}: t = {time:.9g} s: {reason}")
        self._time, self._size = time, size

    def receive(self, group: int = -1) -> None:
        """Outputs at this time."""
        end = self._ends[group]
        if end:
            values = self._recording.outputs(self._time, self._size)
            self._output[:end] = values[self._places[:end]]

    def set(self, start: dict[str, float | str]) -> None:
        """`InstanceFailure`: a recording has no parameters."""
        if start:
            raise InstanceFailure(f"{self.name}: a recording has no parameter {min(start)!r}")

    def save(self) -> Any:
        """Time and size of the last step."""
        return self._time, self._size

    def restore(self, state: Any) -> None:
        """Go back to a saved time."""
        self.rollbacks += 1
        self._time, self._size = state

    def forget(self, state: Any) -> None:
        """Nothing to free."""

    def close(self) -> None:
        """Nothing to end."""
