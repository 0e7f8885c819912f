"""The native part and the Python part give the same bits, the same states, the same words."""

from __future__ import annotations

from pathlib import Path

import pytest

import build_fmus
from tests.fmus.native.pair import Library
from tests.fmus.native.wander import wander

PARTS = build_fmus.compilable()


@pytest.mark.parametrize("name", PARTS)
def test_a_random_walk(native: Path, tmp_path: Path, name: str) -> None:
    """Random inputs, parameters, resets, rollbacks and faults."""
    pair = wander(name, Library(native / f"{name}.fmu", tmp_path), 1000, seed=3)
    assert pair.discarded > 0 or not pair.inputs, "nothing that a unit without inputs could refuse"


@pytest.mark.slow
@pytest.mark.parametrize("name", PARTS)
def test_a_long_random_walk(native: Path, tmp_path: Path, name: str) -> None:
    wander(name, Library(native / f"{name}.fmu", tmp_path), 100_000, seed=11)


def test_all_parts_but_the_monolith() -> None:
    assert set(build_fmus.part_names()) - set(PARTS) == {"monolith"}
