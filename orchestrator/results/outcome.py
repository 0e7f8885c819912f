"""The outcome of a run: what it recorded, and how it went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ..scenario.plan import Plan
from .segments import Segments
from .texts import Change, texts_at


@dataclass(frozen=True)
class Estimate:
    """Estimated largest error of a variable over a run, absolute and by its largest value."""

    error: float
    relative: float


@dataclass(frozen=True)
class Report:
    """What an instance has reported: its messages, and how many steps came back with a warning.

    `warning` is the first message with that status, "" where there was no text.
    """

    messages: list[str]
    warned: int
    warning: str


@dataclass(frozen=True)
class Outcome:
    """What a run recorded, and how it went. `failure` is None for a whole run.

    `points` are its communication points, `rejected` counts the attempts beside them, `calls` and
    `rollbacks` those of each instance, `residual` is what remained of the initial conditions,
    `couplings` the energy created and exchanged by each power coupling [J].
    `estimates` holds the error of each real variable and `metric_errors` that of each metric in SI,
    `doubt` the reason where there are none; `unseen` what they do not cover, by component or
    variable: :mod:`orchestrator.results.error_estimate`. `python_loop` is the reason why the
    communication loop ran in Python, "" for the compiled one. `segments` holds the rows of a long
    run that have left memory; `times` and `rows` are then the last ones. `reports` are those of
    each instance, `texts` the changes of each recorded text.
    """

    plan: Plan
    names: list[str]
    times: NDArray[np.float64]
    rows: NDArray[np.float64]
    wall_time: float
    steps: int
    calls: dict[str, int]
    failure: Exception | None = field(default=None)
    points: Sequence[float] = ()
    rejected: int = 0
    rollbacks: dict[str, int] = field(default_factory=dict)
    residual: float = 0.0
    couplings: dict[str, tuple[float, float]] = field(default_factory=dict)
    segments: Segments | None = None
    estimates: dict[str, Estimate] | None = None
    metric_errors: dict[str, float] = field(default_factory=dict)
    unseen: dict[str, str] = field(default_factory=dict)
    doubt: str = ""
    python_loop: str = ""
    reports: dict[str, Report] = field(default_factory=dict)
    texts: Mapping[str, Sequence[Change]] = field(default_factory=dict)

    @property
    def kept(self) -> int:
        """Number of rows, those that have left memory included."""
        return len(self.times) + (self.segments.rows if self.segments is not None else 0)

    @property
    def simulated(self) -> float:
        """Time [s] from the start of the run to its last communication point kept."""
        return float(self.times[-1] - self.plan.grid.start) if len(self.times) else 0.0

    def series(self, name: str) -> NDArray[Any]:
        """Recorded values of `component.variable`, numbers or texts."""
        if name in self.texts:
            return texts_at(self.texts[name], self.times)
        return np.asarray(self.rows[:, self.names.index(name)])

    def checked(self) -> Self:
        """The same outcome; raises its `failure` where the run did not come to its end."""
        if self.failure is not None:
            raise self.failure
        return self

    def _repr_html_(self) -> str:
        """What a notebook shows: how the run went, its metrics, what was recorded."""
        from ..report.notebook import rendered
        from .card import card

        return rendered(card(self))


def whole(outcome: Outcome) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times and rows of an outcome, those that have left memory included."""
    pieces = list(outcome.segments.pieces()) if outcome.segments else []
    pieces.append((outcome.times, outcome.rows))
    return np.concatenate([p[0] for p in pieces]), np.concatenate([p[1] for p in pieces])
