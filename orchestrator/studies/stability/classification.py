"""The class of one run of a case."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ...results.accuracy import MEANINGLESS
from ...results.outcome import Outcome
from ...results.summary import warnings
from ...simulation.run import estimated

ACCURATE = 1e-2
"""Largest relative error of the leading variables of a run that counts as accurate."""

HONEST = 1.0 / 3.0
"""Share of the true error that an estimate has to reach to count as a warning of it.

One that says that the numbers mean nothing, as `MEANINGLESS` does, counts whatever the true error.
"""

CLASSES = {
    "accurate": f"error at most {ACCURATE:.0%}",
    "inaccurate": "bounded, and its audit or error estimate warns",
    "stopped": "ended by an error that names instance, place and time",
    "silent": "wrong, and nothing warns",
    "late": "not finished within its patience",
    "unjudged": "reached its end; the case has no reference to judge it by",
}


@dataclass(frozen=True)
class Trial:
    """One run: case, master, use of laws, steps in a cycle; its class, and why.

    `error` is the largest relative one of the leading variables; `noticed_by` is what warns of an
    inaccurate run: `audit` (of energy), `estimate` (of the error), or nothing. `usual` marks the
    scenario's own master and step, `auto` the automatic step.
    """

    case: str
    master: str
    laws: str
    per_cycle: int
    kind: str
    error: float | None = None
    noticed_by: str = ""
    reason: str = ""
    wall_time: float = 0.0
    calls: int = 0
    usual: bool = False
    auto: bool = False


def judged(done: Outcome, error: float, names: Iterable[str]) -> tuple[str, str]:
    """Class of a run that reached its end, and what notices its error.

    The error of an inaccurate run is estimated, at twice the run's cost, unless the energy audit
    has warned already.
    """
    if error <= ACCURATE:
        return "accurate", ""
    if any(warning.kind == "coupling energy" for warning in warnings(done)):
        return "inaccurate", "audit"
    found = estimated(done)
    if found.estimates is None:
        return ("inaccurate", "estimate") if found.doubt else ("silent", "")
    estimate = max((found.estimates[name].relative for name in names), default=0.0)
    noticed = estimate >= min(HONEST * error, MEANINGLESS) or bool(found.unseen)
    return ("inaccurate", "estimate") if noticed else ("silent", "")
