"""A part of one's own, outside the package: written, built, checked, run, refused."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import build_fmus
from fmus.export.new_part import FILES, ICONS
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


def spoil(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_it_is_written_built_and_checked_by_two_commands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    made = resilin("new", "part", "coil")
    assert made.exit_code == 0, made.output
    assert made.output.startswith("./coil is a spring that hardens.")
    assert made.output.endswith("then: resilin build ./coil\n")
    assert {path.name for path in Path("coil").iterdir()} == {
        name.format(name="coil") for name in (*FILES.values(), *ICONS)
    }
    built = resilin("build", "./coil")
    assert built.exit_code == 0, built.output
    assert sorted(str(path) for path in Path("build").rglob("*.fmu")) == [
        "build/fmus/coil.fmu",
        "build/native/coil.fmu",
    ]
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
    spoil(coil / "physics.py", "parameter(100.0", "parameter(150.0")
    other = build_fmus.new_part("coil", Path("elsewhere"))
    second = build_fmus.build(str(other), into=tmp_path / "a")
    assert second.guid == first.guid
    (coil / "test_coil.py").write_text("a test is no source of the FMU")
    assert not build_fmus.build(str(other), into=tmp_path / "a").fresh


@pytest.mark.parametrize(
    ("file", "old", "new", "reason"),
    [
        ("reference.csv", "0.216", "0.215", "Python: force.value = 0.216 at t = 0.001 s, where"),
        ("physics.py", "square = place * place", "square = place ** 2.0", "outside the subset"),
    ],
)
def test_a_build_that_fails_leaves_both_kinds_as_they_were(
    coil: Path, file: str, old: str, new: str, reason: str
) -> None:
    """A Python FMU of a text that cannot be compiled would run in the place of the older twin."""
    assert resilin("build", "./coil").exit_code == 0
    before = {path: path.read_bytes() for path in Path("build").rglob("*.fmu")}
    assert len(before) == 2
    spoil(coil / file, old, new)
    done = resilin("build", "./coil")
    assert done.exit_code == 2
    assert reason in done.output
    assert {path: path.read_bytes() for path in Path("build").rglob("*.*")} == before


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
        ("physics.py", '"N/m", "Stiffness', '"N/metre", "Stiffness', "coil: stiffness: unit 'N/me"),
        ("physics.py", 'depends=("motion",)', 'depends=("moton",)', "no input 'moton'; did you me"),
        ("reference.csv", "0.004", "four", "reference.csv: line 3: 'four' is not a number"),
        ("reference.csv", ",100.0,0.0", ",100.0", "line 5: 5 values under 6 names"),
        ("reference.csv", "=100", "=soft", "line 1: 'soft' is not a number"),
        ("reference.csv", "0.002,0.0,0.2", "0.0005,0.0,0.2", "a column time that rises from 0"),
    ],
)
def test_what_is_wrong_with_a_folder_is_told(
    coil: Path, file: str, old: str, new: str, reason: str
) -> None:
    spoil(coil / file, old, new)
    done = resilin("build", "./coil")
    assert done.exit_code == 2, done.output
    assert reason in done.output
    assert "Traceback" not in done.output


def test_a_folder_without_a_part_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert "resilin new part NAME makes one" in resilin("build", "./coil").output
    build_fmus.new_part("coil", Path())
    assert "for the folder write ./coil" in resilin("build", "coil").output
