"""Foreign FMUs that crash, hang, hoard or flood: the run ends with the reason, nothing is left."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.errors import InitialisationError, SimulationError
from orchestrator.fmi.instance.base import MOST_MESSAGES
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.system import System
from tests.foreign.scenarios import VERSIONS, Shelf, each_version, part, ran, sick

pytestmark = pytest.mark.usefixtures("mark")

BOTH = (
    (1, "its process died of SIGSEGV"),
    (2, "no answer within 2 s; its process was stopped"),
    (3, "is not a finite number"),
    (4, "its process ended itself with exit code 0"),
    (5, "its process died of SIGABRT"),
    (8, "discard"),
    (9, "error: the bearing has seized"),
    (10, "fatal"),
)
OF_FMI_3 = (
    (11, "the unit returned early, at t = 0.045 s"),
    (12, "the unit asks for the end of the simulation"),
    (17, "the unit asks for event mode"),
)


@pytest.mark.parametrize(
    ("version", "fault", "reason"),
    [(v, *entry) for v in VERSIONS for entry in BOTH] + [(3, *entry) for entry in OF_FMI_3],
)
def test_fault_ends_the_run_with_its_reason(
    version: int, fault: int, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = run(load(sick(tmp_path, shelf("FAULTY", version), fault)))
    message = str(outcome.failure)
    assert isinstance(outcome.failure, SimulationError)
    assert message.startswith("sick.y = nan 1 at t = 0.05 s" if fault == 3 else "sick: step from ")
    assert fault == 3 or "from t = 0.04 s by 0.01 s: " in message
    assert reason in message
    assert message.isprintable()
    assert outcome.times == pytest.approx(0.01 * np.arange(5))
    assert outcome.series("sick.y").tolist() == [3.0] * 5


@each_version
def test_value_that_grows_without_end_ends_the_run(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = run(load(sick(tmp_path, shelf("FAULTY", version), 15, stop=2.0)))
    assert "sick.y = 1e+100 1 at t = 1.04 s is outside -1e+100 to 1e+100" in str(outcome.failure)
    assert len(outcome.times) == 104


@each_version
def test_memory_without_end_ends_the_unit_alone(version: int, shelf: Shelf, tmp_path: Path) -> None:
    path = sick(tmp_path, shelf("FAULTY", version), 6, memory="300 MB")
    outcome = run(load(path))
    assert "sick: step from t = 0.04 s" in str(outcome.failure)
    assert "SIGABRT, it seems for want of memory: it may take 300 MB" in str(outcome.failure)
    assert len(outcome.times) == 5


@each_version
def test_flood_of_messages_is_capped(version: int, shelf: Shelf, tmp_path: Path) -> None:
    """10 MB of log with escape codes, and as much on stdout: the first and the last stay."""
    path = sick(tmp_path, shelf("FAULTY", version), 7)
    with System(load(path)) as system:
        unit = system.instances[0].instance
        for k in range(6):
            unit.step(0.01 * k, 0.01)
        assert len(unit.messages) == MOST_MESSAGES
        assert max(len(message) for message in unit.messages) < 520
        assert all(message.startswith("\\x1b[31mxxx") for message in unit.messages)
        assert all(message.isprintable() for message in unit.messages)
    assert len(ran(path).times) == 11


@pytest.mark.parametrize("fault", [13, 16], ids=["crash", "hang"])
@each_version
def test_fault_at_the_very_end_costs_no_result(
    version: int, fault: int, shelf: Shelf, tmp_path: Path
) -> None:
    assert len(ran(sick(tmp_path, shelf("FAULTY", version), fault)).times) == 11


@each_version
def test_unit_that_hangs_when_it_is_made_is_given_up(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    path = sick(tmp_path, shelf("FAULTY", version, fault=14), 14)
    with pytest.raises(InitialisationError, match="sick: instantiating: no answer within 2 s"):
        run(load(path))


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_unit_that_refuses_to_be_made_says_why(
    version: int, isolate: bool, shelf: Shelf, tmp_path: Path
) -> None:
    with (
        zipfile.ZipFile(shelf("FAULTY", version)) as old,
        zipfile.ZipFile(tmp_path / "other.fmu", "w") as new,
    ):
        for name in old.namelist():
            text = old.read(name)
            if name.endswith(".xml"):
                text = text.replace(b'guid="', b'guid="not-').replace(b'Token="', b'Token="not-')
            new.writestr(name, text)
    with pytest.raises(InitialisationError, match="sick: cannot be instantiated: refused: a wrong"):
        run(load(sick(tmp_path, tmp_path / "other.fmu", 0, isolate=isolate)))


@pytest.mark.parametrize("fault", [1, 9], ids=["crash", "error"])
@pytest.mark.parametrize("master", ["gauss-seidel", "jacobi", "iterative", "interface-newton"])
def test_sick_unit_is_named_whatever_the_master(
    master: str, fault: int, shelf: Shelf, tmp_path: Path
) -> None:
    well = part("well", shelf("MASS", 2), isolate=False)
    chosen = f'[master]\nkind = "{master}"'
    held = {"well.force": 1.0}
    outcome = run(load(sick(tmp_path, shelf("FAULTY", 2), fault, well, chosen, held=held)))
    assert str(outcome.failure).startswith("sick: step from t = 0.04 s by 0.01 s: ")
    assert len(outcome.times) == 5


@pytest.mark.parametrize(
    ("fault", "isolate", "reason"),
    [
        (1, True, "its process died of SIGSEGV"),
        (2, True, "no answer within 2 s; its process was stopped"),
        (8, True, "discard"),
        (9, True, "error: the bearing has seized"),
        (10, True, "fatal"),
        (10, False, "fatal"),
    ],
)
def test_attempts_at_shorter_steps_keep_the_reason(
    fault: int, isolate: bool, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    """A failing step is taken again, shorter, as long as the unit lives."""
    path = sick(tmp_path, shelf("FAULTY", 2), fault, isolate=isolate)
    outcome = run(load(path, time={"tolerance": 1e-3}))
    message = str(outcome.failure)
    assert message.startswith("sick: step from t = ")
    assert reason in message
    assert len(outcome.times) > 1


def test_sick_unit_on_the_command_line(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = sick(tmp_path, shelf("FAULTY", 3), 9)
    result = CliRunner().invoke(cli.app, ["run", str(path), "--output", "out.nc"])
    (line,) = result.stderr.splitlines()
    assert result.exit_code == 1
    assert line.startswith("resilin: sick: step from t = 0.04 s by 0.01 s: error: the bearing has")
    assert line.endswith("; 5 rows are kept in out.partial.nc")
    with xarray.open_dataset("out.partial.nc") as data:
        assert (data.attrs["complete"], data.sizes["time"]) == (0, 5)
        assert "the bearing has seized" in data.attrs["reason"]
