"""Runs in a process beside the master's: rows, signals and ends; the faults are in fmi/instance."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import InitialisationError, InputError, OutputError, ResilinError
from orchestrator.fmi.instance.place import Place
from orchestrator.fmi.instance.protocol import Frames, Garbled, answer
from orchestrator.results.outcome import whole
from orchestrator.results.segments import Segments
from orchestrator.scenario.processes import MASTERS, OWN, SHARED, process_of
from orchestrator.simulation.guarded.job import Job, noted, raised
from orchestrator.simulation.guarded.kept import kept_between_runs
from orchestrator.simulation.guarded.process import GuardedProcess
from orchestrator.simulation.guarded.shared import Board, Files, SharedRows, discard, written
from orchestrator.simulation.interrupt import Interrupt, Interrupted
from orchestrator.simulation.load import load
from orchestrator.simulation.observers import Observer
from orchestrator.simulation.run import estimated, run
from orchestrator.simulation.view import View
from tests.foreign.scenarios import (
    Shelf,
    each_version,
    faulty,
    hold,
    level_control,
    masses,
    part,
    ran,
    ring,
    scenario,
    wires,
)
from tests.processes import hosts

pytestmark = pytest.mark.usefixtures("mark")
LONG = 2e4
"""Seconds of steps of 0.01 s whose rows do not stay in memory as one segment."""


def test_each_instance_has_its_process(shelf: Shelf, library: Path, tmp_path: Path) -> None:
    def processes(*texts: str) -> list[str]:
        plan = load(scenario(tmp_path, *texts), library=library)
        return [process_of(plan, name) for name in plan.order]

    ours, held = part("ours", "payload"), hold({"ours.force.value": 0.0})
    both = hold({"ours.force.value": 0.0, "theirs.force": 0.0})
    assert processes(ours, held) == [MASTERS]
    assert processes(ours, part("theirs", shelf("MASS", 2)), both) == [SHARED, SHARED]
    alone = part("theirs", shelf("MASS", 2), isolate=True)
    assert sorted(processes(ours, alone, both)) == [OWN, MASTERS]
    trusted = part("theirs", shelf("MASS", 2), isolate=False)
    assert processes(ours, trusted, both) == [MASTERS, MASTERS]
    plan = load(ring(tmp_path, shelf("GAIN", 2, once=True), (0.5, 0.5)))
    assert [process_of(plan, name) for name in plan.order] == [OWN, OWN]


def test_estimates_are_the_same_guarded_or_not(shelf: Shelf, tmp_path: Path) -> None:
    outcomes = [
        estimated(ran(masses(tmp_path, shelf, master="gauss-seidel", isolate=isolate)))
        for isolate in (None, False)
    ]
    assert outcomes[0].estimates == outcomes[1].estimates
    assert outcomes[0].estimates


@each_version
def test_a_recording_feeds_a_foreign_instance(shelf: Shelf, tmp_path: Path, version: int) -> None:
    """It has no version of FMI, and goes into the process with the foreign one."""
    (tmp_path / "bench.csv").write_text("time,u\n0,0\n0.05,1\n0.1,3\n")
    rows = []
    for isolate in (None, False):
        gain = part("gain", shelf("GAIN", version), start={"gain": 2.0}, isolate=isolate)
        bench = '[components.bench]\ndata = "./bench.csv"\ninterpolation = "linear"'
        rows.append(ran(scenario(tmp_path, gain, bench, wires("bench.u -> gain.u"))))
    assert np.array_equal(rows[0].rows, rows[1].rows)
    assert rows[0].series("gain.y")[-1] == pytest.approx(6.0)


def test_an_observer_sees_foreign_instances_too(shelf: Shelf, tmp_path: Path) -> None:
    class Last(Observer):
        seen = 0.0

        def sample(self, view: View) -> None:
            self.seen = view["a.displacement"]

    observer = Last()
    path = masses(tmp_path, shelf, master="gauss-seidel")
    outcome = run(load(path), observers=[observer], estimate=False).checked()
    assert outcome.series("a.displacement")[-1] == observer.seen
    assert outcome.rows.tobytes() == ran(path).rows.tobytes()


@pytest.mark.parametrize("fault", [0, 1], ids=["to the end", "crash"])
def test_rows_of_a_long_run_leave_memory(fault: int, shelf: Shelf, tmp_path: Path) -> None:
    """The master writes the segments; with those in memory they are the rows of a run in one."""
    path = faulty(tmp_path, shelf("FAULTY", 2), fault, stop=LONG)
    if fault:
        text = path.read_text().replace('"fault_time" = 0.05', '"fault_time" = 15000.0')
        path.write_text(text)
    segments = Segments(tmp_path / "out.segments", [], {})
    outcome = run(load(path), segments=segments, estimate=False)
    times, rows = whole(outcome)
    assert segments.digests
    assert (outcome.failure is None) == (fault == 0)
    expected = 1_500_000 if fault else 2_000_001
    assert len(times) == len(rows) == expected
    assert np.array_equal(times[:-1], 0.01 * np.arange(expected - 1))
    assert (rows[:, outcome.names.index("faulty.y")] == 3.0).all()
    segments.remove()


def test_a_disk_that_takes_no_segment_ends_the_run_and_keeps_its_rows(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: Segments, times: object, rows: object) -> None:
        raise OutputError("out: no space left")

    monkeypatch.setattr(Segments, "write", full)
    path = faulty(tmp_path, shelf("FAULTY", 2), 0, stop=LONG)
    segments = Segments(tmp_path / "out.segments", [], {})
    outcome = run(load(path), segments=segments, estimate=False)
    assert isinstance(outcome.failure, OutputError)
    assert str(outcome.failure) == "out: no space left"
    assert len(outcome.times) > 100_000


def test_a_signal_ends_the_run_at_a_communication_point(shelf: Shelf, tmp_path: Path) -> None:
    with Interrupt() as interrupt:
        os.kill(os.getpid(), signal.SIGTERM)
        path = faulty(tmp_path, shelf("FAULTY", 2), 0, stop=5e6)
        outcome = run(load(path), interrupt=interrupt)
    assert isinstance(outcome.failure, Interrupted)
    assert outcome.failure.exit_code == 128 + signal.SIGTERM
    assert outcome.python_loop == ""


def test_an_interrupt_that_is_no_signal_ends_the_run_too(shelf: Shelf, tmp_path: Path) -> None:
    """As the deadline of a study: what its check raises is the reason."""

    class Late(Interrupt):
        looks = 0

        def check(self) -> None:
            self.looks += 1
            if self.looks > 3:
                raise Interrupted(signal.SIGTERM)

    path = faulty(tmp_path, shelf("FAULTY", 2), 0, stop=5e6)
    outcome = run(load(path), interrupt=Late())
    assert isinstance(outcome.failure, Interrupted)


def test_an_error_of_its_own_code_is_told(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where the package in the process is another one: its last words are quoted."""
    (tmp_path / "sitecustomize.py").write_text("import pickle\npickle.loads = None\n")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    path = masses(tmp_path, shelf)
    with pytest.raises(InitialisationError, match="exit code 3; its last output: TypeError"):
        run(load(path))


@pytest.fixture
def made() -> Iterator[Files]:
    """Files of a run."""
    files = Files.made()
    yield files
    files.close()


def test_rows_are_whole_once_their_time_stands(made: Files) -> None:
    memory = SharedRows(made)
    times, rows = memory.extended(np.empty(0), np.empty((0, 2)), 4)
    rows[:2] = [[1.0, 2.0], [3.0, 4.0]]
    times[0] = 0.5
    assert [a.tolist() for a in written(made, 2)] == [[0.5], [[1.0, 2.0]]]
    times[1] = 0.6
    times, rows = memory.extended(times, rows, 8)
    assert rows[:2].tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert [len(a) for a in written(made, 2)] == [2, 2]
    discard(made)
    assert np.isnan(times).all()
    assert [a.shape for a in written(made, 2)] == [(0,), (0, 2)]
    assert [a.shape for a in written(made, 0)] == [(0,), (0, 0)]


def test_both_processes_see_one_board(made: Files) -> None:
    made.clear(2)
    ours, theirs = Board(made.board, 2), Board(made.board, 2)
    ours.header.stop = 15
    with ours.places[1].at(0):
        assert theirs.places[1].busy
    assert not theirs.places[1].busy
    assert theirs.header.stop == 15
    assert isinstance(theirs.places[0], Place)
    del ours, theirs
    made.clear(2)
    assert Board(made.board, 2).header.stop == 0


@pytest.mark.parametrize("kind", [OutputError, InputError, InitialisationError, ResilinError])
def test_errors_arrive_as_they_were(kind: type[Exception]) -> None:
    back = raised(json.loads(json.dumps(noted(kind("what; way out")))))
    assert type(back) is kind
    assert str(back) == "what; way out"


def test_an_error_of_no_known_kind_is_one_of_the_run() -> None:
    assert type(raised({"kind": "SystemExit", "text": "x"})).__name__ == "SimulationError"
    assert type(raised({"kind": "nearest", "text": "x"})).__name__ == "SimulationError"
    assert raised(None) is None


def test_answers_come_in_any_pieces() -> None:
    data = answer(b"m", [0, 1, "text"]) + answer(b"k", {"a": 1}, b"12345678") + answer(b"w")
    expected = [(b"m", [0, 1, "text"], b""), (b"k", {"a": 1}, b"12345678"), (b"w", None, b"")]
    assert Frames().feed(data) == expected
    frames = Frames()
    assert [f for k in range(len(data)) for f in frames.feed(data[k : k + 1])] == expected


@pytest.mark.parametrize("data", [b"k" + 8 * b"\xff", answer(b"k", "x").replace(b'"x"', b'"x{')])
def test_what_is_no_answer_is_refused(data: bytes) -> None:
    with pytest.raises(Garbled):
        Frames().feed(data)


def test_names_of_files_count_from_where_they_are_written(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Parts from the master's folder, files of parameters from the scenario's."""
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "table.txt").write_text("7.5\n")
    (tmp_path / "decay.fmu").write_bytes(shelf("DECAY", 2).read_bytes())
    unit = part("decay", "../decay.fmu", start={"table": "table.txt"})
    record = '[record]\nvariables = ["decay.*"]'
    scenario(tmp_path / "scene", unit, record)
    monkeypatch.chdir(tmp_path)
    outcome = run(load(Path("scene") / "scenario.toml"), estimate=False).checked()
    assert outcome.series("decay.found")[-1] == 7.5


def test_one_process_serves_the_runs_of_a_study(shelf: Shelf, tmp_path: Path, mark: str) -> None:
    plan = load(masses(tmp_path, shelf, master="gauss-seidel"))
    with kept_between_runs():
        first = run(plan, estimate=False)
        (process,) = hosts(mark)
        second = run(plan)
        assert [host.pid for host in hosts(mark)] == [process.pid]
        other = load(masses(tmp_path, shelf, master="jacobi"))
        run(other, estimate=False)
        assert [host.pid for host in hosts(mark)] == [process.pid]
        run(load(level_control(tmp_path, shelf)), estimate=False)
        assert len(hosts(mark)) == 2
    assert hosts(mark) == []
    assert first.rows.tobytes() == second.rows.tobytes()


def test_fmus_that_want_a_process_of_their_own_get_a_new_one(
    shelf: Shelf, tmp_path: Path, mark: str
) -> None:
    once = part("a", shelf("GAIN", 2, once=True))
    plan = load(scenario(tmp_path, once, hold({"a.u": 1.0})))
    with kept_between_runs():
        for _ in range(2):
            run(plan, estimate=False).checked()
            assert hosts(mark) == []


def test_a_process_that_dies_late_is_no_evidence(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run in a process that has run before is made again where that process dies."""
    carry_out = GuardedProcess.carry_out
    killed = []

    def killing(self: GuardedProcess, job: Job) -> None:
        carry_out(self, job)
        if self.used > 1:
            self.kill()
            killed.append(self.used)

    plan = load(masses(tmp_path, shelf, master="gauss-seidel"))
    with kept_between_runs():
        first = run(plan, estimate=False).checked()
        monkeypatch.setattr(GuardedProcess, "carry_out", killing)
        second = run(plan, estimate=False).checked()
    assert killed == [2]
    assert first.rows.tobytes() == second.rows.tobytes()


def test_a_crash_in_a_study_is_told_as_in_a_run(shelf: Shelf, tmp_path: Path) -> None:
    good = load(faulty(tmp_path, shelf("FAULTY", 2), 0))
    bad = load(faulty(tmp_path, shelf("FAULTY", 2), 1))
    with kept_between_runs():
        run(good, estimate=False).checked()
        outcome = run(bad, estimate=False)
        assert "step from t = 0.04 s by 0.01 s: its process was ended by SIGSEGV" in str(
            outcome.failure
        )
        assert len(outcome.times) == 5
        run(good, estimate=False).checked()
