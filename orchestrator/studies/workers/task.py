"""A worker's answer to a task: there is one whether the run succeeds or fails."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

from ...errors import InputError, SimulationError, printable
from ...simulation.interrupt import Interrupted

LONGEST = 900
"""Characters of a reason in an answer, at most."""


class RunFailed(Exception):
    """A run that stopped before its end, after `steps` communication steps."""

    def __init__(self, reason: str, steps: int = 0) -> None:
        super().__init__(reason)
        self.steps = steps


def answered(work: Callable[[], Mapping[str, Any]], empty: Mapping[str, Any]) -> dict[str, Any]:
    """The result of `work`, marked `done`, with the time that it took.

    Where the run fails: `failed` with the reason, and the `empty` fields in place of results.
    Input that this worker cannot use gives `unfit` with the reason: another worker may be able to.
    """
    begun = perf_counter()
    steps = 0
    try:
        found = work()
        if "unfit" in found:
            return dict(found)
        return {"status": "done", "reason": "", **found, "wall_time": perf_counter() - begun}
    except InputError as error:
        return {"unfit": str(error)}
    except Interrupted:
        raise
    except (RunFailed, SimulationError) as error:
        reason, steps = str(error), getattr(error, "steps", 0)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    reason = printable(reason.replace("\n", "; "), most=LONGEST)
    spent = perf_counter() - begun
    return {**empty, "status": "failed", "reason": reason, "wall_time": spent, "steps": steps}
