"""Iterative master: sequential passes over one step, with rollback, until values settle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..errors import Divergence
from ..system import System


@dataclass(frozen=True)
class Iterative:
    """Repeat a sequential step from saved states until no output changes any more.

    The first pass is that of the sequential master; in later ones every unit sees what the
    others put out at the end of the step, so laws hold at both ends of the loop and held
    values act as in an implicit method. Converges where the coupling's gain over a step is
    below one; `Divergence` names the value that does not settle within `most` passes.
    Needs rollback in every unit. `tolerance` is relative to the largest value seen.
    """

    needs_rollback: ClassVar[bool] = True
    tolerance: float = 1e-9
    most: int = 30

    def advance(self, system: System, time: float, size: float) -> None:
        saved = [(member.unit, member.unit.save()) for member in system.members]
        try:
            for index in range(self.most):
                before = system.values.copy()
                if index:
                    for unit, state in saved:
                        unit.restore(state)
                for member in system.members:
                    member.advance(time, size)
                for member in system.followers:
                    member.follow()
                change = np.abs(system.values - before)
                scale = np.maximum(np.abs(system.values), np.abs(before))
                if index and bool((change <= self.tolerance * scale + 1e-300).all()):
                    return
        finally:
            for unit, state in saved:
                unit.forget(state)
        worst = int(np.argmax(change / (scale + 1e-300)))
        raise Divergence(
            f"{system.names[worst]} does not settle at t = {time:.9g} s: it still changes by"
            f" {change[worst]:.2g} after {self.most} passes; lower the step or use laws"
        )
