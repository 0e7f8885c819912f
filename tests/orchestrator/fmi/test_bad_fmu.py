"""FMU files of a scenario that cannot be used."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

from fmpy import platform

from tests.orchestrator.good_scenario import PART, TIME, Refuse, changed, invoke


def copied(source: Path, target: Path, keep: Callable[[str], bool]) -> None:
    """Copy those entries of an archive that are to be kept."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in filter(keep, old.namelist()):
            new.writestr(name, old.read(name))


def test_file_that_is_not_a_zip_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "own.fmu").write_bytes(b"MZ\x1b[31m not a zip")
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert "components.payload.fmu: " in line
    assert "own.fmu: not a zip archive, 17 bytes" in line


def test_zip_without_description_is_refused(refuse: Refuse, desk: Path, library: Path) -> None:
    copied(library / "payload.fmu", desk / "own.fmu", lambda name: not name.endswith(".xml"))
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert "own.fmu: not an FMU: no modelDescription.xml" in line


def test_fmu_for_another_platform_is_refused(refuse: Refuse, desk: Path, library: Path) -> None:
    copied(library / "payload.fmu", desk / "own.fmu", lambda name: platform not in name)
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert f"own.fmu: no binary for {platform} (available: " in line
    assert "rebuild" in line


def test_binary_that_is_not_a_library_is_refused(refuse: Refuse, desk: Path, library: Path) -> None:
    copied(library / "payload.fmu", desk / "own.fmu", lambda name: not name.endswith(".so"))
    with zipfile.ZipFile(desk / "own.fmu", "a") as archive:
        archive.writestr(f"binaries/{platform}/payload.so", b"not a library")
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert "own.fmu: cannot be loaded" in line


def test_stop_beyond_the_singularity_is_refused(desk: Path, library: Path) -> None:
    """No single value is out of its bounds: only the instance itself finds out, when it starts."""
    text = f"""
    [time]
    {TIME}
    [components.linkage]
    fmu = "linkage"
    start = {{ stop_travel = "9 mm" }}
    [hold]
    "linkage.force.value" = 0
    "linkage.load.torque" = 0
    """
    (desk / "bad.toml").write_text(text)
    code, lines, error = invoke(library, "bad.toml")
    assert isinstance(error, SystemExit)
    assert code == 2
    (line,) = lines
    assert line.startswith("resilin: ")
    assert "linkage" in line
    assert "stop_travel reaches the linkage's singularity" in line
    assert not (desk / "out.nc").exists()
    assert list(Path(tempfile.gettempdir()).iterdir()) == []
