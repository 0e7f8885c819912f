"""The base class of masters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

from ...scenario.schema import MasterSettings
from ..system import System


class Master(ABC):
    """Takes a system from one communication point to the next, for one run.

    After `advance(time, size)` every value in `system.values` holds at `time + size`. A
    master that `needs_rollback` is refused at load where an instance cannot roll back; `options`
    are the keys of a scenario's [master] that it uses, beside kind, laws, order.
    """

    needs_rollback: ClassVar[bool] = False
    options: ClassVar[tuple[str, ...]] = ()

    def __init__(self, system: System, settings: MasterSettings) -> None:
        self.system = system
        self.settings = settings

    @abstractmethod
    def advance(self, time: float, size: float) -> None:
        """One communication step of `size` [s]."""

    def interrupt(self) -> None:  # noqa: B027  (most masters remember nothing)
        """Forget what was learned from earlier steps: a discontinuity lies between."""

    def remember(self) -> Any:
        """What the master has learned so far, for :meth:`recall` after a rollback."""
        return None

    def recall(self, memory: Any) -> None:  # noqa: B027
        """Restore what :meth:`remember` returned."""
