"""What a master is."""

from __future__ import annotations

from typing import ClassVar, Protocol

from ..system import System


class Master(Protocol):
    """Takes a system from one communication point to the next.

    After `advance(system, time, size)` every value in `system.values` holds at
    `time + size`. A master keeps nothing between calls. One that `needs_rollback` is refused
    at load where a unit cannot roll back.
    """

    needs_rollback: ClassVar[bool]

    def advance(self, system: System, time: float, size: float) -> None: ...
