"""An instance as a master uses it, wherever it runs.

Legal order of calls, as in FMI: `connect`, `prepare` (parameters), `enter_initialisation`,
then any number of `send` and `receive`, `exit_initialisation`, then `send`, `step`,
`receive` in rounds, at last `close`. After an `InstanceFailure` only `restore`, `forget` and
`close` may follow.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from ctypes import c_int32
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..description import Interface, Variable
from .message_log import FAULTY, MessageLog

STATUS = ("OK", "warning", "discard", "error", "fatal", "pending")
Values = NDArray[np.float64]


@dataclass(frozen=True)
class Limits:
    """What an isolated instance may use: seconds for one call, bytes of memory."""

    patience: float = 30.0
    memory: int = 4 << 30


class Instance(ABC):
    """An instance of an FMU.

    Inputs and outputs travel through the buffers given to :meth:`connect`, in the order of
    the variables given there. The caller keeps the time: an instance only passes it on.
    `warned` counts the steps that came back with a warning.
    """

    interpolates = False
    """Whether :meth:`incline` means something to it."""

    def __init__(self, name: str, interface: Interface) -> None:
        self.name = name
        self.interface = interface
        self._log = MessageLog(name)
        self.warned = 0
        self.steps = 0
        self.rollbacks = 0
        self._faults = c_int32()

    @abstractmethod
    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        """Set parameters and start values by name, and announce the experiment.

        `stop` is None where its end is not to be announced.
        """

    @abstractmethod
    def connect(
        self,
        inputs: list[Variable],
        input_values: Values,
        outputs: list[list[Variable]],
        output_values: Values,
    ) -> None:
        """Bind buffers: `send` passes all inputs, `receive(k)` the outputs of group 0 to k."""

    @abstractmethod
    def read_whole_at_once(self) -> None:
        """Let every `receive` read all outputs: for instances that no later pass reads again."""

    @abstractmethod
    def enter_initialisation(self) -> None:
        """Begin initialisation mode."""

    @abstractmethod
    def exit_initialisation(self) -> None:
        """End initialisation mode; the instance can step."""

    @abstractmethod
    def send(self) -> None:
        """Pass the input buffer to the FMU."""

    def rates(self) -> Values | None:
        """Rates of change [1/s] of the outputs now, in the order of :meth:`connect`.

        None where the instance gives none, or not for all of them.
        """
        return None

    def incline(self, rates: Values) -> None:
        """Let the inputs rise from what was sent, by their rates [1/s], over the coming step.

        A rate for each input of :meth:`connect`; only continuous reals may have one that is not 0.
        """
        raise NotImplementedError(f"{self.name} holds its inputs over a step")

    @abstractmethod
    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]; `InstanceFailure` unless the status is OK."""

    @abstractmethod
    def receive(self, group: int = -1) -> None:
        """Fill the output buffer, up to a group; all by default."""

    def texts(self, variables: list[Variable]) -> list[str]:
        """Present texts of String variables; of a kind of instance that has any."""
        raise NotImplementedError

    @abstractmethod
    def set(self, start: dict[str, float | str]) -> None:
        """Set tunable parameters by name, between steps."""

    @abstractmethod
    def save(self) -> Any:
        """FMU state as it is now, to be given to :meth:`restore` and :meth:`forget`."""

    @abstractmethod
    def restore(self, state: Any) -> None:
        """Go back to a saved state, which stays saved."""

    @abstractmethod
    def forget(self, state: Any) -> None:
        """Free a saved state."""

    @abstractmethod
    def close(self) -> None:
        """End the instance; safe to call twice, and after a failure."""

    @property
    def faults(self) -> int:
        """Messages with an error since the instance began to step, or was last restored."""
        return self._faults.value

    @faults.setter
    def faults(self, count: int) -> None:
        self._faults.value = count

    def log(self, status: int, message: str) -> None:
        """Keep a message of the FMU; of many, the first ones and the last.

        A message with an error counts as a fault even where the call itself returns OK: a
        getter of an exported Python part has no other way to report that it has no value.
        """
        self.faults += status in FAULTY
        self._log.add(status, message)

    @property
    def warning(self) -> str:
        """The first text of a warning; "" where there was none."""
        return self._log.warning

    @property
    def message_count(self) -> int:
        """Number of messages with a text."""
        return self._log.count

    @property
    def logged(self) -> list[tuple[int, str]]:
        """Status and text of the messages that were kept, safe to print."""
        return self._log.entries

    @property
    def messages(self) -> list[str]:
        """The messages that were kept, safe to print."""
        return self._log.texts

    def last_message(self) -> str:
        """`: ` and the last error, then the last message; "" without messages."""
        return self._log.ending()
