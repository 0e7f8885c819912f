"""The few facts of a model description that wiring and running need."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from pathlib import Path

REALS = ("Real", "Float64", "Float32")
SIGNED = {"Int8": 8, "Int16": 16, "Int32": 32, "Int64": 64, "Integer": 32}
UNSIGNED = {"UInt8": 8, "UInt16": 16, "UInt32": 32, "UInt64": 64}
WHOLE = (*SIGNED, *UNSIGNED)
EVENT = "next_event_time"
"""An output that announces the time [s] of the next discontinuity."""
EXACT = 2**53 - 1
"""Whole numbers up to here pass without loss: no other one rounds to the same double."""


def may_start(causality: str | None, variability: str | None, initial: str | None) -> bool:
    """Whether a variable with these attributes may be set before initialisation.

    Parameters and inputs, and of the others those whose `initial` is exact or approx, but no
    constants; structural parameters change the shape of others, which no instance here allows.
    """
    if causality in {"structuralParameter", "independent"} or variability == "constant":
        return False
    return causality in {"parameter", "input"} or initial in {"exact", "approx"}


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU, or one element of an array.

    Arrays (FMI 3) appear as their elements, named `x[1]`, `x[2,3]`; `element` counts them from 0
    in the order in which they are passed, `extent` is their number under the reference.
    `codes` are the numbers of an enumeration's `choices`. `unit` is a text that
    `orchestrator.units` reads as the file defines it, or a name that the file does not define.
    """

    name: str
    reference: int
    kind: str
    causality: str
    unit: str
    description: str
    start: float | str | None
    least: float | None
    most: float | None
    port: str = ""
    order: int = 0
    choices: tuple[str, ...] = ()
    codes: tuple[int, ...] = ()
    depends: tuple[str, ...] | None = None
    variability: str = "continuous"
    element: int = 0
    extent: int = 1
    initial: str = ""
    unit_defined: bool = True

    @property
    def member(self) -> str:
        """Name inside its port; the index of an array's element."""
        return self.name[len(self.port) :].removeprefix(".") if self.port else self.name

    @property
    def real(self) -> bool:
        """Whether it is a floating-point number."""
        return self.kind in REALS

    @property
    def numeric(self) -> bool:
        """Whether it passes between instances: a number, a choice, or true and false."""
        return self.real or self.kind in WHOLE or self.switches

    @property
    def switches(self) -> bool:
        """Whether it is a Boolean or a choice: it jumps, and no number lies between."""
        return self.kind in {"Boolean", "Enumeration"}

    @property
    def rises(self) -> bool:
        """Whether it can change evenly over a step: a continuous double that is no array's."""
        doubles = self.kind in ("Real", "Float64") and self.extent == 1
        return doubles and self.variability == "continuous"

    @property
    def tunable(self) -> bool:
        """Whether it may be set while the instance runs."""
        return self.causality == "input" or self.variability == "tunable"

    @property
    def startable(self) -> bool:
        """Whether it may be set before initialisation."""
        return may_start(self.causality, self.variability, self.initial)

    def span(self) -> tuple[float, float] | None:
        """Least and greatest whole number that its type and a double hold; None if not whole."""
        if self.kind in SIGNED:
            half = 2 ** (SIGNED[self.kind] - 1)
            return float(max(-half, -EXACT)), float(min(half - 1, EXACT))
        if self.kind in UNSIGNED:
            return 0.0, float(min(2 ** UNSIGNED[self.kind] - 1, EXACT))
        return None


@dataclass(frozen=True)
class Interface:
    """Variables and capabilities of an FMU; `step` [s] is the communication step it prefers.

    One for `model_exchange` has so many continuous `states` and event `indicators`, as FMI 2 lists
    them; an FMU for co-simulation has its own solver, and none of these. One that `interpolates`
    takes inputs that change over a step by their rates: those of FMI 2 that say so, and all that
    are integrated here. One with `rates` gives the first derivatives of its outputs.
    One that `restarts` has no states of FMI, and goes back by its continuous states alone.
    """

    path: Path
    version: int
    model: str
    identifier: str
    guid: str
    tool: str
    variables: dict[str, Variable]
    rollback: bool
    variable_step: bool
    once: bool
    needs_tool: bool
    ours: bool
    warnings: tuple[str, ...] = field(default=())
    step: float | None = None
    model_exchange: bool = False
    states: int = 0
    indicators: int = 0
    interpolates: bool = False
    rates: bool = False
    restarts: bool = False

    def of(self, *causalities: str) -> list[Variable]:
        """Variables with one of these causalities, in the FMU's order."""
        return [v for v in self.variables.values() if v.causality in causalities]

    @functools.cached_property
    def _members(self) -> dict[tuple[str, str], list[Variable]]:
        found: dict[tuple[str, str], list[Variable]] = {}
        for v in self.variables.values():
            found.setdefault((v.port, v.causality), []).append(v)
        return found

    def port(self, name: str, causality: str) -> list[Variable]:
        """Members of a port with one causality: annotated, or sharing the prefix."""
        return self._members.get((name, causality), [])

    def ports(self) -> list[str]:
        """Names of all ports."""
        return sorted({v.port for v in self.of("input", "output") if v.port})
