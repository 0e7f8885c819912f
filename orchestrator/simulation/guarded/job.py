"""What the process of a run is given and what it answers.

The job goes one way, pickled: the master trusts itself. Answers come from a process that runs the
code of others, so they are JSON and doubles, and are checked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ... import errors
from ...results.outcome import Outcome, Report
from ...scenario.plan import Plan
from ..interrupt import Interrupted
from .shared import Files

MESSAGE, TEXT, FULL, REPORT, REFUSED, DONE = b"m", b"t", b"w", b"k", b"e", b"d"
"""Letters of the answers: a message, a recorded text, rows for a segment, a report, no start,
instances freed."""
WRITTEN, NOT_WRITTEN = b"k", b"e"
"""Letters of the replies to `FULL`."""


@dataclass(frozen=True)
class Job:
    """A run: its plan, given communication points, the files it shares.

    `segmented` is true where its rows are to leave memory on the way, `probe` where its FMUs are
    tried first, whether they go back.
    """

    plan: Plan
    points: Sequence[float] | None
    files: Files
    segmented: bool
    probe: bool


def noted(error: Exception | None) -> dict[str, Any] | None:
    """An error as JSON."""
    if error is None:
        return None
    if isinstance(error, Interrupted):
        return {"kind": Interrupted.__name__, "number": error.exit_code - 128}
    return {"kind": type(error).__name__, "text": str(error)}


def raised(found: Any) -> Exception | None:
    """The error of a note; `SimulationError` where its kind is none of ours."""
    if found is None:
        return None
    if found["kind"] == Interrupted.__name__:
        return Interrupted(int(found["number"]))
    kind = getattr(errors, str(found["kind"]), None)
    known = isinstance(kind, type) and issubclass(kind, errors.ResilinError)
    made: Exception = (kind if known else errors.SimulationError)(str(found["text"]))  # type: ignore[misc]
    return made


def report(outcome: Outcome, on_grid: bool) -> tuple[dict[str, Any], bytes]:
    """What is told of an outcome, and its communication points where they are not known before."""
    points = b"" if on_grid else np.array(outcome.points, dtype=float).tobytes()
    told = {
        "wall_time": outcome.wall_time,
        "steps": outcome.steps,
        "calls": outcome.calls,
        "failure": noted(outcome.failure),
        "couplings": outcome.couplings,
        "rejected": outcome.rejected,
        "rollbacks": outcome.rollbacks,
        "residual": outcome.residual,
        "python_loop": outcome.python_loop,
        "unseen": outcome.unseen,
        "reports": {
            name: [entry.messages, entry.warned, entry.warning]
            for name, entry in outcome.reports.items()
        },
    }
    return told, points


def reported(told: Any, values: bytes) -> dict[str, Any]:
    """Fields of an outcome from a report; raises what fits not: KeyError, TypeError, ValueError."""
    return {
        "wall_time": float(told["wall_time"]),
        "steps": int(told["steps"]),
        "calls": {str(name): int(count) for name, count in told["calls"].items()},
        "failure": raised(told["failure"]),
        "couplings": {
            str(name): (float(pair[0]), float(pair[1])) for name, pair in told["couplings"].items()
        },
        "points": np.frombuffer(values).tolist(),
        "rejected": int(told["rejected"]),
        "rollbacks": {str(name): int(count) for name, count in told["rollbacks"].items()},
        "residual": float(told["residual"]),
        "python_loop": str(told["python_loop"]),
        "unseen": {str(name): str(text) for name, text in told["unseen"].items()},
        "reports": {
            str(name): Report([str(text) for text in entry[0]], int(entry[1]), str(entry[2]))
            for name, entry in told["reports"].items()
        },
    }
