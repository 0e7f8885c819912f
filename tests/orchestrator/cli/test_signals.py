"""Signals to the command: the rows are kept, with the right exit code."""

from __future__ import annotations

import signal
import sys
import tempfile
from pathlib import Path

import pytest
import xarray

from orchestrator import cli
from orchestrator.simulation.interrupt import Interrupt
from tests.orchestrator.good_scenario import changed
from tests.processes import resilin, started, until


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_signal_that_is_ignored_stays_ignored(number: signal.Signals) -> None:
    """As under nohup, or in the background of a shell script."""
    before = signal.signal(number, signal.SIG_IGN)
    try:
        with Interrupt():
            assert signal.getsignal(number) is signal.SIG_IGN
        assert signal.getsignal(number) is signal.SIG_IGN
    finally:
        signal.signal(number, before)


@pytest.mark.parametrize(
    ("number", "ignored"),
    [
        (signal.SIGINT, ()),
        (signal.SIGTERM, ()),
        (signal.SIGHUP, ()),
        (signal.SIGTERM, ("SIGINT",)),
        (signal.SIGHUP, ("SIGINT",)),
        (signal.SIGTERM, ("SIGINT", "SIGHUP")),
    ],
)
def test_signal_stops_a_run_and_keeps_its_rows(
    number: signal.Signals, ignored: tuple[str, ...], desk: Path, library: Path
) -> None:
    """Sent once its FMUs are unpacked; a signal that the parent ignores has no effect."""
    text = changed('"0.01 s"', '"100000 s"').replace("0.1 N", "1e-9 N")
    (desk / "long.toml").write_text(text)
    temporary = Path(tempfile.gettempdir())
    options = ["--fmus", library, "--output", "out.nc"]
    command = resilin("run", "long.toml", *options, ignored=ignored)
    with started(command, TMPDIR=str(temporary)) as process:
        until(lambda: any(temporary.iterdir()), process)
        for name in ignored:
            process.send_signal(signal.Signals[name])
        process.send_signal(number)
        _, stderr = process.communicate()
    assert list(temporary.iterdir()) == []
    assert process.returncode == 128 + number
    (line,) = stderr.splitlines()
    assert line.startswith(f"resilin: stopped by {number.name}; ")
    assert line.endswith("rows are kept in out.partial.nc")
    assert sorted(p.name for p in desk.glob("*out*")) == ["out.partial.nc"]
    with xarray.open_dataset("out.partial.nc") as data:
        assert data.attrs["complete"] == 0
        assert number.name in data.attrs["reason"]
        assert data.sizes["time"] >= 1
        assert bool((data["payload.velocity"].diff("time") > 0.0).all())


def test_second_interrupt_has_the_same_exit_code(
    desk: Path, library: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second Ctrl-C acts at once, wherever the run is."""

    def interrupted(*arguments: object, **options: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestrator.simulation.run.run", interrupted)
    options = ["--fmus", str(library), "--output", "out.nc"]
    monkeypatch.setattr(sys, "argv", ["resilin", "run", "good.toml", *options])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 130
    assert "Traceback" not in capsys.readouterr().err
