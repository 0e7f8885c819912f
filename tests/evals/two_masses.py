"""Two unit masses, each on a spring to the ground, and a spring between them: closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.foreign.build import foreign

HEAD = """
[time]
stop = 10
step = 1e-2
[components.pair]
fmu = "./pair.fmu"
isolate = false
[record]
variables = ["first.displacement", "second.displacement"]
"""
NUMBERS = (
    HEAD
    + """
[master]
order = ["first", "second", "pair"]
[components.first]
fmu = "./mass.fmu"
isolate = false
start = { start_displacement = 1.0 }
[components.second]
fmu = "./mass.fmu"
isolate = false
"""
    + "".join(
        f"""
[[wires]]
from = "{mass}.displacement"
to = "pair.{mass}.displacement"
[[wires]]
from = "{mass}.velocity"
to = "pair.{mass}.velocity"
[[wires]]
from = "pair.{mass}.value"
to = "{mass}.force"
"""
        for mass in ("first", "second")
    )
)
"""Masses without laws: bare numbers cross."""

LAWS = (
    HEAD
    + """
[master]
order = ["first", "second", "pair"]
[components.first]
fmu = "payload"
start = { start_displacement = 1.0, mass = 1.0 }
[components.second]
fmu = "payload"
start = { mass = 1.0 }
"""
    + "".join(
        f"""
[[wires]]
from = "{mass}.motion"
to = "pair.{mass}"
[[wires]]
from = "pair.{mass}"
to = "{mass}.force"
"""
        for mass in ("first", "second")
    )
)
"""The part `payload` as both masses: the pair's whole law crosses."""


def scenarios(folder: Path, *, rollback: bool = True) -> Path:
    """Both scenarios and their FMUs in a folder: numbers.toml, laws.toml."""
    for model in ("PAIR", "MASS"):
        foreign(model, folder, rollback=rollback)
    (folder / "numbers.toml").write_text(NUMBERS)
    (folder / "laws.toml").write_text(LAWS)
    return folder


def exact(times: NDArray[np.float64], stiffness: float = 1.0) -> NDArray[np.float64]:
    """Displacement of the first mass: cos t and cos sqrt(1 + 2 k) t, half each."""
    fast = np.sqrt(1.0 + 2.0 * stiffness)
    return np.asarray(0.5 * (np.cos(times) + np.cos(fast * times)))
