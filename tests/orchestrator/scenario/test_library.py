"""Which FMU of a part is taken from a library of both kinds."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import build_fmus
from orchestrator.errors import ScenarioError
from orchestrator.scenario.library import built_part
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run


@pytest.fixture
def both(python_parts: Path, native: Path, tmp_path: Path) -> Path:
    """A library with the parts of `oscillator-1` in both kinds."""
    for name in ("amplifier", "spring", "payload"):
        for kind, folder in (("fmus", python_parts), ("native", native)):
            (tmp_path / kind).mkdir(exist_ok=True)
            shutil.copyfile(folder / f"{name}.fmu", tmp_path / kind / f"{name}.fmu")
    return tmp_path


def kinds(folder: Path) -> dict[str, str]:
    """Kind of FMU that a scenario takes for each component."""
    plan = load("oscillator-1", None, folder)
    return {name: interface.path.parent.name for name, interface in plan.interfaces.items()}


def test_compiled_parts_are_taken_where_they_are_as_new(both: Path) -> None:
    assert set(kinds(both).values()) == {"native"}


def test_a_compiled_part_of_other_sources_is_left_alone(both: Path) -> None:
    """Another start value is another build: its compiled FMU no longer stands for the part."""
    build_fmus.build(
        "spring", alias="spring_stiff", changes={"stiffness": "900 N/m"}, into=both / "other"
    )
    shutil.copyfile(both / "other" / "spring_stiff.fmu", both / "fmus" / "spring.fmu")
    assert kinds(both) == {"amplifier": "native", "spring": "fmus", "payload": "native"}


def test_a_part_of_one_kind_is_taken_from_there(both: Path) -> None:
    (both / "fmus" / "spring.fmu").unlink()
    (both / "native" / "payload.fmu").unlink()
    assert kinds(both) == {"amplifier": "native", "spring": "native", "payload": "fmus"}


def test_a_folder_of_fmus_is_taken_as_it_is(both: Path) -> None:
    assert set(kinds(both / "fmus").values()) == {"fmus"}
    assert set(kinds(both / "native").values()) == {"native"}


def test_a_damaged_compiled_part_is_left_alone(both: Path) -> None:
    (both / "native" / "spring.fmu").write_bytes(b"PK")
    assert built_part("spring", both) == both / "fmus" / "spring.fmu"


def test_both_kinds_give_the_same_rows(both: Path) -> None:
    time = {"stop": "2 cycles"}
    rows = [
        run(load("oscillator-1", None, folder, time=time)).rows.tobytes()
        for folder in (both, both / "fmus")
    ]
    assert rows[0] == rows[1]


def test_a_part_that_was_not_built_is_named_with_its_command(tmp_path: Path) -> None:
    (tmp_path / "fmus").mkdir()
    with pytest.raises(ScenarioError, match=r"fmus, which holds no FMU; run: resilin build"):
        load("oscillator-1", None, tmp_path)
