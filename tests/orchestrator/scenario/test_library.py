"""Which FMU of a part is taken from a library of both kinds."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import build_fmus
from orchestrator.cli import common
from orchestrator.errors import ScenarioError
from orchestrator.scenario import library as search
from orchestrator.scenario.library import LIBRARY, built_part, located, part_names
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
    with pytest.raises(ScenarioError, match=r"which holds no FMU; run: resilin build") as raised:
        load("oscillator-1", None, tmp_path)
    assert f"in {tmp_path}," in raised.value.problems[0]


def test_a_folder_below_build_that_is_not_there_is_named(elsewhere: Path) -> None:
    with pytest.raises(ScenarioError, match=r"in build/nowhere, which holds no FMU"):
        load("oscillator-1", None, Path("build/nowhere"))


def project(folder: Path, both: Path) -> Path:
    """A folder with parts in `build` and a scenario further down."""
    shutil.copytree(both, folder / "build")
    scenario = folder / "scenarios" / "mine.toml"
    scenario.parent.mkdir()
    scenario.write_text('extends = "oscillator-1"\n')
    return scenario


@pytest.fixture
def elsewhere(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder without parts, on a machine without a checkout that has any."""
    folder = tmp_path_factory.mktemp("elsewhere")
    monkeypatch.chdir(folder)
    monkeypatch.setattr(search, "CHECKOUT", folder / "none")
    return folder


def test_parts_are_found_from_the_scenario_upwards(
    both: Path, elsewhere: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    scenario = project(tmp_path_factory.mktemp("project"), both)
    plan = load(scenario)
    home = scenario.parents[1] / "build" / "native"
    assert {interface.path.parent for interface in plan.interfaces.values()} == {home}


def test_parts_are_found_from_the_current_folder_upwards_first(
    both: Path, elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(both, elsewhere / "build")
    scenario = project(elsewhere / "project", both)
    assert built_part("spring", located(LIBRARY, scenario)).parent == LIBRARY / "native"
    below = elsewhere / "other" / "below"
    below.mkdir(parents=True)
    monkeypatch.chdir(below)
    found = built_part("spring", located(LIBRARY, scenario))
    assert found.parent == elsewhere / "build" / "native"


def test_parts_are_found_in_the_checkout(
    both: Path, elsewhere: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkout = elsewhere.parent / "checkout"
    shutil.copytree(both, checkout / "build")
    monkeypatch.setattr(search, "CHECKOUT", checkout)
    assert located(LIBRARY) == LIBRARY, "a folder that is no checkout"
    for name in ("build_fmus.py", "pyproject.toml"):
        (checkout / name).touch()
    assert located(LIBRARY) == checkout / "build"


def test_a_build_without_parts_is_passed_over(
    both: Path, elsewhere: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    (elsewhere / "build" / "fmus").mkdir(parents=True)
    scenario = project(tmp_path_factory.mktemp("project"), both)
    assert located(LIBRARY, scenario) == scenario.parents[1] / "build"


def test_each_part_is_taken_from_the_nearest_folder_that_has_it(
    both: Path, elsewhere: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """A part of one's own hides no other, for a run, of one kind alone, and in a process below."""
    scenario = project(tmp_path_factory.mktemp("project"), both)
    for kind in ("fmus", "native"):
        (elsewhere / "build" / kind).mkdir(parents=True)
        shutil.copyfile(both / kind / "spring.fmu", elsewhere / "build" / kind / "spring.fmu")
    shutil.copyfile(both / "fmus" / "spring.fmu", elsewhere / "build" / "fmus" / "own.fmu")
    home = scenario.parents[1] / "build"

    def folders(library: Path) -> list[Path]:
        plan = load(scenario, None, library)
        return [plan.interfaces[name].path.parent for name in ("spring", "amplifier", "payload")]

    assert folders(LIBRARY) == [LIBRARY / "native", home / "native", home / "native"]
    assert folders(common.library(LIBRARY, False, scenario)) == [
        LIBRARY / "fmus", home / "fmus", home / "fmus",
    ]  # fmt: skip
    found = located(LIBRARY, scenario)
    assert part_names(found) == ["amplifier", "own", "payload", "spring"]
    absolute = folders(Path(str(found.absolute())))
    assert absolute == [elsewhere / "build" / "native", home / "native", home / "native"]
    with pytest.raises(ScenarioError, match="no part 'amplifier' in") as raised:
        load(scenario, None, elsewhere / "build")
    assert str(home) not in str(raised.value)


def test_a_folder_that_is_named_is_not_looked_for(both: Path, elsewhere: Path) -> None:
    assert located(Path("parts"), both / "fmus" / "mine.toml") == Path("parts")


def test_where_no_part_is_built_the_places_are_named(
    elsewhere: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    scenario = tmp_path_factory.mktemp("project") / "mine.toml"
    scenario.write_text('extends = "oscillator-1"\n')
    with pytest.raises(ScenarioError) as raised:
        load(scenario)
    for text in (str(elsewhere), str(scenario.parent), "run: resilin build,", "--fmus"):
        assert text in raised.value.problems[0]
