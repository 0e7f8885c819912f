"""What a result says of its run beside its rows: whether to trust it, what was changed and lost."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..errors import printable
from ..scenario.plan import Plan
from .accuracy import meaningless
from .outcome import Outcome
from .summary import warnings

LONGEST = 1000
"""Characters of a text that comes from a file."""


@dataclass(frozen=True)
class RunNotes:
    """Remarks on one run.

    `verdict` is why its numbers say nothing, "" where they do. `changes` are the settings given
    beside the scenario's file, by name; `dropped` is what the scenario lost by its recordings or
    FMUs.
    """

    verdict: str = ""
    warnings: Sequence[str] = ()
    changes: Mapping[str, str] = field(default_factory=dict)
    dropped: Sequence[str] = ()

    @property
    def changed(self) -> str:
        """The changes in one line, as `amplifier.frequency = 16 Hz`."""
        return ", ".join(f"{name} = {value}" for name, value in self.changes.items())


def notes_of(outcome: Outcome) -> RunNotes:
    """Remarks on a run in memory."""
    plan = outcome.plan
    told = [_short(warning) for warning in warnings(outcome)]
    return RunNotes(
        _short(meaningless(outcome)),
        told,
        {_short(name): _short(value) for name, value in plan.changes.items()},
        list(map(_short, plan.dropped)),
    )


def attributes_of(plan: Plan) -> dict[str, str]:
    """What is known before the run, as netCDF attributes."""
    return {"changes": json.dumps(plan.changes), "dropped": json.dumps(plan.dropped)}


def attributes(outcome: Outcome) -> dict[str, str]:
    """What is known after it."""
    notes = notes_of(outcome)
    return {"verdict": notes.verdict, "warnings": json.dumps(list(notes.warnings))}


def read(found: Mapping[Any, Any]) -> RunNotes:
    """Remarks from the attributes of a file; none from those that cannot be read."""
    changes, texts = _json(found, "changes"), [_json(found, k) for k in ("warnings", "dropped")]
    told, dropped = ([_short(each) for each in t] if isinstance(t, list) else [] for t in texts)
    return RunNotes(
        _short(found.get("verdict", "")),
        told,
        {_short(k): _short(v) for k, v in changes.items()} if isinstance(changes, dict) else {},
        dropped,
    )


def _json(found: Mapping[Any, Any], key: str) -> Any:
    try:
        return json.loads(found.get(key, "null"))
    except (TypeError, ValueError, RecursionError):
        return None


def _short(text: object) -> str:
    return printable(str(text), most=LONGEST)
