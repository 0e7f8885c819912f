"""Sweeps that are killed or stopped half way."""

from __future__ import annotations

import os
import signal
import tempfile
from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.results.netcdf import partial_path
from orchestrator.simulation.interrupt import Interrupt, Interrupted
from tests.orchestrator.studies.sweeps import SCENARIO, STROKE, Sweep, files
from tests.processes import marked, python, resilin, started, until, when

SCRIPT = """
import os, signal, sys
from pathlib import Path
from orchestrator.studies.sweep import study

class Mortal(study.Checkpoint):
    written = 0
    def write(self, point, record):
        super().write(point, record)
        self.written += 1
        if self.written == 3:
            os.kill(os.getpid(), signal.SIGKILL)

if __name__ == "__main__":
    study.Checkpoint = Mortal
    axis, library, target = sys.argv[1:]
    options = {"time": {"stop": "2 cycles"}}
    study.sweep("flapping-spring-full-wings", [study.parse_axis(axis)], Path(library), Path(target),
                workers=1, options=options)
"""


def test_a_sweep_killed_half_way_goes_on_where_it_was(
    swept: Sweep, library: Path, tmp_path: Path, mark: str
) -> None:
    """kill -9 at the third point: its workers end too, every point is kept, none is run twice."""
    target = tmp_path / "out.nc"
    axis = "amplifier.frequency=15:22/8Hz"
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    (tmp_path / "kept").mkdir()
    with started(python(script, axis, library, target), TMPDIR=str(tmp_path / "kept")) as process:
        process.wait()
        until(lambda: marked(mark) == [])
    assert process.returncode == -signal.SIGKILL
    kept = files(target)
    assert len(kept) == 3
    assert not target.exists()
    data = swept(axis, target=target, keep=True)
    assert kept.items() <= files(target).items()
    assert len(files(target)) == 8
    assert set(data["status"].values) == {"done"}
    direct = swept("amplifier.frequency=15,22Hz", target=tmp_path / "ends.nc")
    np.testing.assert_array_equal(data[STROKE].values[[0, -1]], direct[STROKE].values)


@pytest.mark.parametrize(
    ("number", "ignored"),
    [(signal.SIGINT, ()), (signal.SIGTERM, ("SIGINT",))],
    ids=["terminal", "background"],
)
def test_signal_keeps_what_is_there(
    number: signal.Signals, ignored: tuple[str, ...], library: Path, tmp_path: Path, mark: str
) -> None:
    """As a terminal sends it, to all processes: exit 130, one line, no process left.

    In the background of a shell, which ignores SIGINT, SIGTERM to the sweep alone has its effect.
    """
    target = tmp_path / "out.nc"
    command = ["sweep", SCENARIO, "--stop", "2 cycles", "--over", "amplifier.frequency=5:40/100Hz"]
    command += ["--output", target, "--fmus", library, "--workers", "2"]
    temporary = tempfile.gettempdir()
    with started(resilin(*command, ignored=ignored), TMPDIR=temporary) as process:
        until(lambda: len(files(target)) >= 3, process)
        os.killpg(process.pid, signal.SIGINT)
        if number != signal.SIGINT:
            process.send_signal(number)
        errors = process.communicate()[1]
        until(lambda: marked(mark) == [])
    assert process.returncode == 128 + number
    assert errors == f"resilin: stopped by {number.name}\n"
    with xarray.open_dataset(partial_path(target)) as read:
        status = list(read["status"].values)
        assert status.count("done") >= 3
        assert set(status) == {"done", "missing"}
        assert read.attrs["complete"] == 0
        assert np.isnan(read[STROKE].values[status.index("missing")])
    assert not target.exists()


def test_an_interrupt_comes_through(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    interrupt = Interrupt()
    with (
        when(lambda: files(target), lambda: setattr(interrupt, "number", signal.SIGTERM)),
        pytest.raises(Interrupted) as caught,
    ):
        swept("amplifier.frequency=5:40/100Hz", target=target, interrupt=interrupt)
    assert caught.value.exit_code == 143
    assert partial_path(target).exists() and files(target)
