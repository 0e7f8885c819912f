"""Which library of an FMU is loaded."""

from __future__ import annotations

import zipfile
from pathlib import Path

import fmpy
import pytest

from orchestrator.errors import FmuError
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.scenarios import Shelf, each_version, hold, last, part, ran, scenario

pytestmark = pytest.mark.usefixtures("mark")


@each_version
def test_library_of_another_name_is_found(version: int, shelf: Shelf, tmp_path: Path) -> None:
    mass = shelf("MASS", version, library="other.so", name="misnamed")
    outcome = ran(scenario(tmp_path, part("m", mass), hold({"m.force": 2.0})))
    assert last(outcome)["m.displacement"] == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_two_libraries_of_other_names_are_refused(
    version: int, isolate: bool, shelf: Shelf, tmp_path: Path
) -> None:
    path = tmp_path / "two.fmu"
    path.write_bytes(shelf("MASS", version, library="other.so", name="misnamed").read_bytes())
    place = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(f"binaries/{place}/another.so", b"")
    reason = r"two\.fmu: no library mass\.so for .*, but another\.so, other\.so; name the right"
    with pytest.raises(FmuError, match=reason):
        run(load(scenario(tmp_path, part("m", path, isolate=isolate), hold({"m.force": 0.0}))))
