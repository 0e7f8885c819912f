"""A part of one's own, outside the package: written, built, checked, run, refused."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import build_fmus
from fmus.export.new_part import FILES
from orchestrator.cli import app
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.processes import python

SCENARIO = """
[time]
stop = "0.2 s"
step = "0.5 ms"
[components.own]
fmu = "coil"
[components.payload]
fmu = "payload"
start = { mass = "10 g", start_displacement = "4 mm" }
[[wires]]
from = "own.force"
to = "payload.force"
[[wires]]
from = "payload.motion"
to = "own.motion"
[record]
variables = ["own.elastic_energy", "payload.displacement", "payload.kinetic_energy"]
"""


@pytest.fixture
def coil(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return build_fmus.new_part("coil", Path())


def resilin(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments), env={"COLUMNS": "80"})


def test_it_is_written_built_and_checked_by_two_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    made = resilin("new", "part", "coil")
    assert made.exit_code == 0, made.output
    assert made.output == (
        "./coil: change physics.py and reference.csv; then: resilin build ./coil\n"
    )
    assert {path.name for path in Path("coil").iterdir()} == {
        name.format(name="coil") for name in FILES.values()
    }
    built = resilin("build", "./coil")
    assert built.exit_code == 0, built.output
    for kind in ("fmus", "native"):
        assert f"build/{kind}/coil.fmu: off its reference answer by 0e+00" in built.output
    assert "unchanged" in resilin("build", "./coil").output
    assert "stiffness" in resilin("parts", "coil").output


def test_its_own_test_passes(coil: Path) -> None:
    done = subprocess.run(
        python("-m", "pytest", "-q", "-p", "no:cacheprovider", coil),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "4 passed" in done.stdout


def test_it_runs_beside_a_part_of_the_package(coil: Path, library: Path) -> None:
    """Both kinds to the same bits; the energy of spring and mass stays to the law's order."""
    Path("own.toml").write_text(SCENARIO)
    found = []
    for native in (False, True):
        folder = Path("native" if native else "python")
        build_fmus.build("./coil", native=native, into=folder)
        (folder / "payload.fmu").symlink_to(library / "payload.fmu")
        found.append(run(load("own.toml", None, folder), estimate=False).checked())
    for name in found[0].names:
        assert np.array_equal(found[0].series(name), found[1].series(name))
    energy = found[1].series("own.elastic_energy") + found[1].series("payload.kinetic_energy")
    assert np.abs(energy / energy[0] - 1.0).max() < 5e-3


def test_a_changed_source_is_another_build(coil: Path, tmp_path: Path) -> None:
    """And a folder of the same name elsewhere is not taken for it."""
    first = build_fmus.build("./coil", into=tmp_path / "a")
    physics = coil / "physics.py"
    physics.write_text(physics.read_text().replace("parameter(100.0", "parameter(150.0"))
    other = build_fmus.new_part("coil", Path("elsewhere"))
    second = build_fmus.build(str(other), into=tmp_path / "a")
    assert second.guid == first.guid
    (coil / "test_coil.py").write_text("a test is no source of the FMU")
    assert not build_fmus.build(str(other), into=tmp_path / "a").fresh


def test_what_is_off_its_reference_answer_is_refused_and_not_left(coil: Path) -> None:
    reference = coil / "reference.csv"
    reference.write_text(reference.read_text().replace("0.216", "0.215"))
    done = resilin("build", "./coil")
    assert done.exit_code == 2
    assert "force.value = 0.216 at t = 0.001 s, where" in done.output
    assert "has 0.215" in done.output
    assert not Path("build/fmus/coil.fmu").exists()


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("spring", "'spring' is the name of a part of the package"),
        ("law", "'law' is a module of the package"),
        ("Coil", "'Coil' cannot name a part"),
        ("a-b", "'a-b' cannot name a part"),
        ("class", "'class' cannot name a part"),
        ("coil", "coil is there already"),
    ],
)
def test_a_name_that_cannot_be_is_refused(coil: Path, name: str, reason: str) -> None:
    done = resilin("new", "part", name)
    assert done.exit_code == 2
    assert reason in " ".join(done.output.split())


@pytest.mark.parametrize(
    ("file", "old", "new", "reason"),
    [
        ("slave.py", "PART", "PARD", "has no PART of the name 'coil'"),
        ("slave.py", '"coil"', '"coils"', "has no PART of the name 'coil'"),
        ("physics.py", "return x", "return x +", "invalid syntax"),
        ("physics.py", "from ..law", "from ..lore", "physics.py:7: ModuleNotFoundError"),
        ("physics.py", "= place * place", "= place @ place", "physics.py:68: `place @ place`"),
        ("reference.csv", "force.value", "force.valve", "no variable 'force.valve'; did you mean"),
        ("reference.csv", "0.004", "four", "is no reference answer"),
        ("reference.csv", "0.002,0.0,0.2", "0.0005,0.0,0.2", "its times have to rise from 0"),
    ],
)
def test_what_is_wrong_with_a_folder_is_told(
    coil: Path, file: str, old: str, new: str, reason: str
) -> None:
    path = coil / file
    path.write_text(path.read_text().replace(old, new))
    done = resilin("build", "./coil")
    assert done.exit_code == 2, done.output
    assert reason in done.output
    assert "Traceback" not in done.output


def test_a_folder_without_a_part_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert "resilin new part NAME makes one" in resilin("build", "./coil").output
    build_fmus.new_part("coil", Path())
    assert "for the folder write ./coil" in resilin("build", "coil").output
