"""Execution order from the wires, where a scenario gives none."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.scenario.execution_order import deciders, reachable
from orchestrator.simulation.load import load
from tests.foreign.build import foreign

CHAIN = """
[time]
stop = 1.0
step = 0.1
"""


def scenario(folder: Path, listed: str, wires: str, held: str) -> Path:
    """GAINs named by letters; `ab` is a wire from a to b."""
    foreign("GAIN", folder)
    text = CHAIN + "".join(f'[components.{name}]\nfmu = "./gain.fmu"\n' for name in listed)
    text += "".join(
        f'[[wires]]\nfrom = "{a}.y"\nto = "{b}.u"\ngain = 0.1\n' for a, b in wires.split()
    )
    text += "[hold]\n" + "".join(f'"{name}.u" = 1.0\n' for name in held)
    path = folder / "scenario.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("listed", "wires", "held", "order"),
    [
        ("cba", "ab bc", "a", "abc"),
        ("dcba", "ab ac bd", "a", "acbd"),
        ("cab", "ab bc ca", "", "cab"),
        ("dabc", "ab bc cd", "a", "abcd"),
    ],
)
def test_sources_first_loops_as_listed(
    tmp_path: Path, library: Path, listed: str, wires: str, held: str, order: str
) -> None:
    plan = load(scenario(tmp_path, listed, wires, held), None, library)
    assert "".join(plan.order) == order


def test_a_given_order_is_kept(tmp_path: Path, library: Path) -> None:
    path = scenario(tmp_path, "cba", "ab bc", "a")
    assert load(path, None, library, master={"order": ["b", "c", "a"]}).order == ["b", "c", "a"]


def test_what_jumps_at_announced_times_only_is_stepped_last(library: Path) -> None:
    """The controller's commands: the step before an edge is taken with the level before it."""
    plan = load("flapping-controlled", None, library)
    assert deciders(plan.connections, plan.interfaces) == {"controller"}
    listed = load("flapping-controlled", None, library, master={"order": []})
    assert listed.order[-1] == "controller"


def test_reachable_along_one_edge_or_more() -> None:
    found = reachable(["a", "b", "c"], [("a", "b"), ("b", "a")])
    assert found == {"a": {"a", "b"}, "b": {"a", "b"}, "c": set()}
