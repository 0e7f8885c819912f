"""The stability study over systems of other people's FMUs: nothing is wrong without a word.

`-s` prints the table and the counts.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.studies.stability import CLASSES, Case, stability
from orchestrator.studies.stability.chart import table
from tests.foreign.scenarios import (
    Shelf,
    hold,
    level_control,
    masses,
    part,
    populations,
    quarter_car,
    scenario,
    wires,
)

pytestmark = pytest.mark.slow


def charging(folder: Path, shelf: Shelf) -> Path:
    """1 V through 1 Ohm into 1 F: a voltage is the velocity of a mass, a current its force."""
    resistor = {"stiffness": 0.0, "ground_stiffness": 0.0, "damping": 1.0}
    source = {"first.displacement": 0.0, "second.displacement": 0.0, "second.velocity": 1.0}
    return scenario(
        folder,
        part("resistor", shelf("PAIR", 2), start=resistor),
        part("capacitor", shelf("MASS", 3)),
        wires(
            "capacitor.velocity -> resistor.first.velocity",
            "resistor.first.value -> capacitor.force",
        ),
        hold({f"resistor.{name}": value for name, value in source.items()}),
        '[record]\nvariables = ["*"]\nleading = ["capacitor.velocity"]',
        stop=5.0,
        step=0.02,
    )


def cases(folder: Path, shelf: Shelf) -> list[Case]:
    """Each system with the frequency in whose cycles its steps are counted."""

    def case(name: str, frequency: float) -> Case:
        place = folder / name
        place.mkdir()
        path = systems[name](place, shelf)
        tree = {"extends": str(path), "time": {"frequency": frequency}}
        return Case(name=name, title=name, scenario=tree)

    systems = {
        "masses": masses,
        "charging": charging,
        "populations": populations,
        "quarter-car": quarter_car,
        "level-control": level_control,
    }
    return [
        case("masses", 0.42),
        case("charging", 0.16),
        case("populations", 0.34),
        case("quarter-car", 1.3),
        case("level-control", 1.23),
    ]


def test_nothing_is_wrong_without_a_word(shelf: Shelf, tmp_path: Path) -> None:
    listed = cases(tmp_path, shelf)
    study = stability(listed, tmp_path / "cases.toml", tmp_path)
    from rich.console import Console

    Console(width=150).print(table(study))
    for only in (None, "usual", "auto"):
        found = study.count(only)  # type: ignore[arg-type]
        print(only or "all", ", ".join(f"{found[kind]} {kind}" for kind in CLASSES))
    for trial in study.trials:
        if trial.usual or trial.auto or trial.kind == "silent":
            print(trial)
    print(study.references)
    assert study.count()["silent"] == 0
    assert study.count()["late"] == 0
    assert study.count("auto")["accurate"] == len(listed)
