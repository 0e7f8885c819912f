"""Foreign FMUs that crash, hang or flood: the run ends with the reason, no process is left."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.errors import InitialisationError, SimulationError
from orchestrator.fmi.instance.message_log import MOST_MESSAGES
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.system import System
from tests.foreign.scenarios import VERSIONS, Shelf, each_version, faulty, part, ran
from tests.processes import marked

pytestmark = pytest.mark.usefixtures("mark")

BOTH = (
    (1, "its process was ended by SIGSEGV"),
    (2, "no answer within 2 s; its process was stopped"),
    (3, "is not a finite number"),
    (4, "its process ended with exit code 0"),
    (5, "its process was ended by SIGABRT"),
    (8, "discard"),
    (9, "error: the bearing has seized"),
    (10, "fatal"),
)
OF_FMI_3 = (
    (11, "the FMU returned early, at t = 0.045 s"),
    (12, "the FMU requests the end of the simulation"),
    (17, "the FMU requests event mode"),
)


GUARDED, OWN = None, True


@pytest.mark.parametrize(
    ("version", "isolate", "fault", "reason"),
    [(v, GUARDED, *entry) for v in VERSIONS for entry in BOTH]
    + [(3, GUARDED, *entry) for entry in OF_FMI_3]
    + [(2, OWN, *entry) for entry in BOTH],
)
def test_fault_ends_the_run_with_its_reason(
    version: int, isolate: bool | None, fault: int, reason: str, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = run(load(faulty(tmp_path, shelf("FAULTY", version), fault, isolate=isolate)))
    message = str(outcome.failure)
    assert isinstance(outcome.failure, SimulationError)
    assert message.startswith(
        "faulty.y = nan 1 at t = 0.05 s" if fault == 3 else "faulty: step from "
    )
    assert fault == 3 or "from t = 0.04 s by 0.01 s: " in message
    assert reason in message
    assert message.isprintable()
    assert outcome.times == pytest.approx(0.01 * np.arange(5))
    assert outcome.series("faulty.y").tolist() == [3.0] * 5


@each_version
def test_value_that_grows_without_end_ends_the_run(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = run(load(faulty(tmp_path, shelf("FAULTY", version), 15, stop=2.0)))
    assert "faulty.y = 1e+100 1 at t = 1.04 s is outside -1e+100 to 1e+100" in str(outcome.failure)
    assert len(outcome.times) == 104


@each_version
def test_memory_without_end_ends_only_its_process(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    path = faulty(tmp_path, shelf("FAULTY", version), 6, memory="300 MB")
    outcome = run(load(path))
    assert "faulty: step from t = 0.04 s" in str(outcome.failure)
    assert "SIGABRT, probably out of memory: its limit is 300 MB" in str(outcome.failure)
    assert len(outcome.times) == 5


@each_version
def test_flood_of_messages_is_capped(version: int, shelf: Shelf, tmp_path: Path) -> None:
    """10 MB of log with escape codes, and as much on stdout: the first and the last stay."""
    path = faulty(tmp_path, shelf("FAULTY", version), 7)
    with System(load(path)) as system:
        instance = system.instances[0].instance
        for k in range(6):
            instance.step(0.01 * k, 0.01)
        assert len(instance.messages) == MOST_MESSAGES
        assert max(len(message) for message in instance.messages) < 520
        assert all(message.startswith("\\x1b[31mxxx") for message in instance.messages)
        assert all(message.isprintable() for message in instance.messages)
    assert len(ran(path).times) == 11


@pytest.mark.parametrize("fault", [13, 16], ids=["crash", "hang"])
@each_version
def test_fault_at_the_very_end_costs_no_result(
    version: int, fault: int, shelf: Shelf, tmp_path: Path
) -> None:
    outcome = ran(faulty(tmp_path, shelf("FAULTY", version), fault))
    assert len(outcome.times) == 11
    how = "ended by SIG" if fault == 13 else "no answer within 2 s"
    report = outcome.reports["faulty"]
    assert report.warned == 1
    assert report.warning.startswith("closing: ")
    assert how in report.warning


@pytest.mark.parametrize("isolate", [GUARDED, OWN], ids=["guarded", "isolated"])
def test_a_process_that_leaves_its_session_is_ended_too(
    isolate: bool | None, shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    ran(faulty(tmp_path, shelf("FAULTY", 2), 18, isolate=isolate))
    assert marked(mark) == []


@each_version
def test_instance_that_hangs_when_it_is_made_is_given_up(
    version: int, shelf: Shelf, tmp_path: Path
) -> None:
    path = faulty(tmp_path, shelf("FAULTY", version, fault=14), 14)
    with pytest.raises(InitialisationError, match="faulty: instantiating: no answer within 2 s"):
        run(load(path))


@pytest.mark.parametrize("isolate", [None, True, False], ids=["guarded", "isolated", "in process"])
@each_version
def test_refused_instantiation_has_its_reason(
    version: int, isolate: bool | None, shelf: Shelf, tmp_path: Path
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
    with pytest.raises(
        InitialisationError, match="faulty: cannot be instantiated: refused: a wrong"
    ):
        run(load(faulty(tmp_path, tmp_path / "other.fmu", 0, isolate=isolate)))


@pytest.mark.parametrize("fault", [1, 9], ids=["crash", "error"])
@pytest.mark.parametrize("master", ["gauss-seidel", "jacobi", "iterative", "interface-newton"])
def test_faulty_instance_is_named_by_every_master(
    master: str, fault: int, shelf: Shelf, tmp_path: Path
) -> None:
    well = part("well", shelf("MASS", 2), isolate=False)
    chosen = f'[master]\nkind = "{master}"'
    held = {"well.force": 1.0}
    outcome = run(load(faulty(tmp_path, shelf("FAULTY", 2), fault, well, chosen, held=held)))
    assert str(outcome.failure).startswith("faulty: step from t = 0.04 s by 0.01 s: ")
    assert len(outcome.times) == 5


@pytest.mark.parametrize(
    ("fault", "isolate", "reason"),
    [
        (1, True, "its process was ended by SIGSEGV"),
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
    """A failing step is taken again, shorter, as long as the instance can step."""
    path = faulty(tmp_path, shelf("FAULTY", 2), fault, isolate=isolate)
    outcome = run(load(path, time={"tolerance": 1e-3}))
    message = str(outcome.failure)
    assert message.startswith("faulty: step from t = ")
    assert reason in message
    assert len(outcome.times) > 1


def test_faulty_instance_on_the_command_line(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = faulty(tmp_path, shelf("FAULTY", 3), 9)
    result = CliRunner().invoke(cli.app, ["run", str(path), "--output", "out.nc"])
    (line,) = result.stderr.splitlines()
    assert result.exit_code == 1
    assert line.startswith(
        "resilin: faulty: step from t = 0.04 s by 0.01 s: error: the bearing has"
    )
    assert line.endswith("; 5 rows are kept in out.partial.nc")
    with xarray.open_dataset("out.partial.nc") as data:
        assert (data.attrs["complete"], data.sizes["time"]) == (0, 5)
        assert "the bearing has seized" in data.attrs["reason"]
