"""One run as data that any tool can take: FMUs, start values, wires, step, watched outputs.

It is written as JSON for a process of its own, which may run another Python: neither this module
nor those of foreign tools in `tools/` import the orchestrator.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Start:
    """A real parameter or input given before the run."""

    name: str
    reference: int
    value: float


@dataclass(frozen=True)
class Component:
    """An FMU under a name, with its start values."""

    name: str
    path: str
    starts: list[Start]


@dataclass(frozen=True)
class Wire:
    """A real number that goes from an output to an input, unchanged."""

    source: str
    output: str
    output_reference: int
    target: str
    input: str
    input_reference: int


@dataclass(frozen=True)
class Watched:
    """An output that is compared."""

    component: str
    name: str
    reference: int


@dataclass(frozen=True)
class Case:
    """A scenario at one step by one wiring.

    `components` are in the order in which a sequential tool should step them. `count` steps of
    `step` [s] are taken; values are compared after `every` so many of them. `rtol` is the
    tolerance of tools that have one in place of a step. `bonds` are pairs of wires, by their
    places, whose values make a power. `scenario`, `library` and `cycles` are for tools that read
    scenarios.
    """

    scenario: str
    library: str
    cycles: float
    per_cycle: int
    wiring: str
    step: float
    count: int
    every: int
    components: list[Component]
    wires: list[Wire]
    watched: list[Watched]
    bonds: list[tuple[int, int]]
    rtol: float = 0.0

    def write(self, path: Path) -> None:
        path.write_text(json.dumps(asdict(self)), encoding="utf-8")


def read(path: Path) -> Case:
    """A case from the file that another process has written."""
    return case_from(json.loads(path.read_text(encoding="utf-8")))


def case_from(found: dict[str, Any]) -> Case:
    components = [
        Component(**{**c, "starts": [Start(**s) for s in c["starts"]]}) for c in found["components"]
    ]
    wires = [Wire(**w) for w in found["wires"]]
    watched = [Watched(**w) for w in found["watched"]]
    bonds = [(a, b) for a, b in found["bonds"]]
    lists: dict[str, Any] = {
        "components": components, "wires": wires, "watched": watched, "bonds": bonds
    }  # fmt: skip
    return Case(**{**found, **lists})
