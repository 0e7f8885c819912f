"""A warning about a finished run: its kind, what it concerns, and the figure behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "still", "coupling energy", "estimated error", "not estimated", "no estimate", "instance", "fmu"
]


@dataclass(frozen=True)
class RunWarning:
    """One warning; `figure` is the number that it rests on, where there is one.

    `still`: what is driven does not move. `coupling energy`: share of the exchanged energy that the
    coupling at `place` has created, negative where it has lost some. `estimated error`: by the
    largest value of the variable at `place`. `not estimated`: what the estimate does not cover at
    `place`. `no estimate`: why there is none at all. `instance`: steps that came back with a
    warning. `fmu`: what is valid but doubtful in the component's modelDescription.
    """

    kind: Kind
    place: str
    text: str
    figure: float | None = None

    def __str__(self) -> str:
        return (
            f"{self.place} {self.text}" if self.figure is not None else f"{self.place}: {self.text}"
        )
