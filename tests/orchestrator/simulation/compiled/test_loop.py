"""The compiled loop against the Python loop: equal rows to the bit, equal counts, equal errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.results.outcome import Outcome
from orchestrator.results.segments import Segments
from orchestrator.scenario.files import scenario_names
from orchestrator.scenario.plan import Plan
from orchestrator.simulation.compiled import drive, library
from orchestrator.simulation.load import load
from orchestrator.simulation.run import replay, run
from tests.foreign.scenarios import Shelf, level_control, masses

Both = Callable[..., tuple[Outcome, Outcome]]
MASTERS = ("gauss-seidel", "jacobi", "extrapolated")
COMPILED = library.missing()
pytestmark = pytest.mark.skipif(bool(COMPILED), reason=COMPILED)


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch) -> Both:
    """Run a plan by both loops, the compiled one first."""

    def runner(plan: Plan, how: Callable[[Plan], Outcome] = run) -> tuple[Outcome, Outcome]:
        compiled = how(plan)
        with monkeypatch.context() as patch:
            patch.setattr("orchestrator.simulation.stepping.unsuited", lambda *_: "a test")
            python = how(plan)
        assert compiled.python_loop == ""
        assert python.python_loop == "a test"
        return compiled, python

    return runner


def assert_same(compiled: Outcome, python: Outcome) -> None:
    np.testing.assert_array_equal(compiled.times, python.times)
    assert compiled.rows.tobytes() == python.rows.tobytes()
    assert str(compiled.failure) == str(python.failure)
    assert type(compiled.failure) is type(python.failure)
    assert compiled.steps == python.steps
    assert compiled.calls == python.calls
    assert compiled.couplings == python.couplings
    assert list(compiled.points) == list(python.points)


@pytest.mark.parametrize("name", scenario_names())
def test_every_shipped_scenario(library: Path, both: Both, name: str) -> None:
    time: dict[str, Any] = {} if "pull-test" in name else {"stop": "3 cycles"}
    if load(name, None, library).frequency is None:
        time = {}
    assert_same(*both(load(name, None, library, time=time)))


@pytest.mark.parametrize("laws", ["held", "affine", "curvature"])
@pytest.mark.parametrize("master", MASTERS)
@pytest.mark.parametrize("name", ["flapping-full-wings", "oscillator-1"])
def test_every_master_and_use_of_laws(
    native: Path, both: Both, name: str, master: str, laws: str
) -> None:
    options = {"time": {"stop": "6 cycles"}, "master": {"kind": master, "laws": laws}}
    assert_same(*both(load(name, None, native, **options)))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_extrapolation_of_every_degree(native: Path, both: Both, degree: int) -> None:
    master = {"kind": "extrapolated", "laws": "held", "degree": degree}
    plan = load("oscillator-1", None, native, time={"stop": "6 cycles"}, master=master)
    assert_same(*both(plan))


@pytest.mark.parametrize(
    ("master", "per_cycle"), [("gauss-seidel", 6), ("jacobi", 12), ("extrapolated", 4)]
)
def test_a_run_that_the_guards_stop(native: Path, both: Both, master: str, per_cycle: int) -> None:
    options = {
        "time": {"stop": "200 cycles", "step": {"per_cycle": per_cycle}},
        "master": {"kind": master, "laws": "held"},
    }
    compiled, python = both(load("oscillator-1", None, native, **options))
    assert_same(compiled, python)
    assert compiled.failure is not None


def test_given_points(native: Path, both: Both) -> None:
    plan = load("flapping-full-wings", None, native, time={"stop": "2 cycles"})
    points = np.cumsum([0.0, *np.tile([1e-4, 3e-4, 7e-4], 30)]).tolist()
    assert_same(*both(plan, lambda plan: replay(plan, points)))


def test_thinned_rows_and_a_last_stretch(native: Path, both: Both) -> None:
    record = {"every": 7, "last": "2 cycles"}
    plan = load("oscillator-1", None, native, time={"stop": "9 cycles"}, record=record)
    compiled, python = both(plan)
    assert_same(compiled, python)
    assert 0 < len(compiled.times) < 40


ACTING = """
extends = "flapping-spring-full-wings"
[time]
stop = "4 cycles"
[[actions]]
at = "1.003 cycles"
set = { "amplifier.amplitude" = "1500 V" }
[[actions]]
at = "2 cycles"
set = { "amplifier.amplitude" = "1000 V" }
[[actions]]
at = "2 cycles"
set = { "aero.air_density" = "0.6 kg/m3" }
"""

FAULTY = """
extends = "oscillator-1"
[time]
stop = "4 cycles"
[[faults]]
at = "1 cycles"
until = "2 cycles"
on = "payload.displacement"
kind = "noise"
size = "1 um"
[[faults]]
at = "3 cycles"
on = "spring"
kind = "drop"
"""


@pytest.mark.parametrize("master", MASTERS)
@pytest.mark.parametrize("text", [ACTING, FAULTY], ids=["actions", "faults"])
def test_actions_and_faults(
    library: Path, tmp_path: Path, both: Both, text: str, master: str
) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(text)
    compiled, python = both(load(path, None, library, master={"kind": master}))
    assert_same(compiled, python)
    assert (compiled.failure is not None) == (text is FAULTY)


def test_rows_that_leave_memory(
    native: Path, tmp_path: Path, both: Both, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Segments are closed while the loop runs; the file that they make is the same."""
    from orchestrator.results.netcdf import segments_for
    from orchestrator.results.outcome import whole

    monkeypatch.setattr("orchestrator.simulation.observers.Recorder.SEGMENT", 60_000)
    plan = load("oscillator-1", None, native, time={"stop": "30 cycles"})
    made: list[Segments] = []

    def segmented(plan: Plan) -> Outcome:
        made.append(segments_for(plan, tmp_path / f"run-{len(made)}.nc"))
        return run(plan, segments=made[-1])

    compiled, python = both(plan, segmented)
    assert compiled.segments and compiled.segments.rows
    for mine, other in zip(whole(compiled), whole(python), strict=True):
        assert mine.tobytes() == other.tobytes()


def test_an_interrupt_ends_a_run_between_two_points(native: Path) -> None:
    from orchestrator.simulation.interrupt import Interrupt, Interrupted

    class Late(Interrupt):
        looked = 0

        def check(self) -> None:
            self.looked += 1
            if self.looked == 2:
                raise Interrupted(15)

    plan = load("flapping-full-wings", None, native, time={"stop": "20000 cycles"})
    done = run(plan, interrupt=Late())
    assert isinstance(done.failure, Interrupted)
    assert 1 < len(done.times) < plan.grid.count
    assert done.steps == max(done.calls.values())


def test_what_is_not_compiled_says_so(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = load(
        "oscillator-1", None, library, time={"stop": "1 cycles"}, master={"kind": "iterative"}
    )
    assert "iterates" in run(plan).python_loop
    monkeypatch.setattr(drive, "missing", lambda: "no C compiler was found")
    plan = load("oscillator-1", None, library, time={"stop": "1 cycles"})
    assert run(plan).python_loop == "no C compiler was found"


@pytest.mark.parametrize("master", MASTERS)
@pytest.mark.parametrize("laws", ["affine", "curvature"])
@pytest.mark.parametrize("name", ["flapping-full-wings", "oscillator-1"])
def test_steps_by_tolerance(native: Path, both: Both, name: str, laws: str, master: str) -> None:
    options = {
        "time": {"stop": "1 cycles", "tolerance": 1e-3},
        "master": {"kind": master, "laws": laws},
    }
    compiled, python = both(load(name, None, native, **options))
    assert_same(compiled, python)
    assert (compiled.rejected, compiled.rollbacks) == (python.rejected, python.rollbacks)


@pytest.mark.parametrize("rollback", [True, False])
@pytest.mark.parametrize("version", [2, 3])
def test_steps_by_tolerance_of_foreign_instances(
    shelf: Shelf, tmp_path: Path, both: Both, version: int, rollback: bool
) -> None:
    """In this process and isolated, with rollback by doubling and without by foresight."""
    for isolate in (False, True):
        path = masses(
            tmp_path, shelf, (version, version), master="gauss-seidel", isolate=isolate,
            rollback=rollback, stop=0.5, more="tolerance = 1e-3",
        )  # fmt: skip
        compiled, python = both(load(path))
        assert_same(compiled, python)
        assert compiled.rejected == python.rejected
        assert compiled.rollbacks == python.rollbacks


@pytest.mark.parametrize("isolate", [False, True])
def test_switches_under_step_control(
    shelf: Shelf, tmp_path: Path, both: Both, isolate: bool
) -> None:
    path = level_control(tmp_path, shelf, isolate=isolate)
    compiled, python = both(load(path, time={"tolerance": 1e-4}))
    assert_same(compiled, python)
    assert compiled.rejected == python.rejected


def test_actions_under_step_control(library: Path, tmp_path: Path, both: Both) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(ACTING.replace("[time]", "[time]\ntolerance = 1e-3"))
    assert_same(*both(load(path, None, library)))
