"""Observers of a user's: what they are called with and when, and that they change nothing."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator import Observer, View, load, run
from orchestrator.errors import Divergence, InputError, ObserverError
from orchestrator.fmi.description import Variable
from orchestrator.scenario.plan import Plan
from orchestrator.simulation import observers as observers_module
from orchestrator.simulation.masters import MASTERS

SCENARIO = "oscillator-1"
TRAVEL = "payload.displacement"
BRIEF = {"stop": "2 cycles"}


class Notes(Observer):
    """Keeps what it is called with; has its own list of calls, or shares one."""

    def __init__(self, calls: list[tuple[str, str]] | None = None, name: str = "") -> None:
        self.calls = calls if calls is not None else []
        self.name = name
        self.steps: list[int] = []
        self.times: list[float] = []
        self.values: list[float] = []
        self.units: dict[str, str] = {}
        self.plan: Plan | None = None

    def start(self, plan: Plan, variables: Mapping[str, Variable]) -> None:
        self.calls.append((self.name, "start"))
        self.plan = plan
        self.units = {name: variable.unit for name, variable in variables.items()}

    def sample(self, view: View) -> None:
        self.calls.append((self.name, "sample"))
        assert tuple(self.units) == view.names
        self.steps.append(view.step)
        self.times.append(view.time)
        self.values.append(view[TRAVEL])


class Failing:
    """Raises at one communication point; a subclass of nothing."""

    def __init__(self, step: int) -> None:
        self.step = step

    def start(self, plan: Plan, variables: Mapping[str, Variable]) -> None:
        if self.step < 0:
            raise RuntimeError("no display")

    def sample(self, view: View) -> None:
        if view.step == self.step:
            raise ValueError("the disk is full")


@pytest.mark.parametrize("kind", MASTERS)
def test_every_point_is_seen_as_it_is_recorded(library: Path, kind: str) -> None:
    plan = load(SCENARIO, None, library, time=BRIEF, master={"kind": kind})
    notes = Notes()
    done = run(plan, observers=[notes])
    assert done.failure is None
    assert notes.calls == [("", "start")] + [("", "sample")] * (plan.grid.count + 1)
    assert notes.plan is plan
    assert notes.units[TRAVEL] == "m"
    assert notes.steps == list(range(plan.grid.count + 1))
    assert notes.times == done.times.tolist()
    assert notes.values == done.series(TRAVEL).tolist()


@pytest.mark.parametrize("time", [BRIEF, {**BRIEF, "tolerance": 1e-3}])
def test_rows_are_the_same_bits_with_and_without(library: Path, time: dict[str, Any]) -> None:
    plan = load(SCENARIO, None, library, time=time)
    alone = run(plan, estimate=False)
    observed = run(plan, estimate=False, observers=[Notes(), Notes()])
    assert alone.rows.tobytes() == observed.rows.tobytes()
    assert alone.times.tobytes() == observed.times.tobytes()


def test_rejected_attempts_are_not_seen(library: Path) -> None:
    """The drive's square edges make steps that are taken again."""
    changes = {"amplifier.waveform": "square"}
    time = {**BRIEF, "step": {"per_cycle": 10}, "tolerance": 1e-5}
    notes = Notes()
    done = run(load(SCENARIO, changes, library, time=time), observers=[notes], estimate=False)
    assert done.rejected > 0
    assert (np.diff(notes.times) > 0.0).all()
    assert set(notes.times) <= set(done.points)
    assert notes.times == done.times.tolist()
    assert notes.values == done.series(TRAVEL).tolist()


def test_all_points_are_seen_whatever_is_kept(library: Path) -> None:
    record = {"every": 7, "last": "1 cycles"}
    plan = load(SCENARIO, None, library, time=BRIEF, record=record)
    notes = Notes()
    done = run(plan, observers=[notes])
    assert len(notes.times) == plan.grid.count + 1
    assert len(done.times) < len(notes.times) / 10


def test_steps_cut_at_an_edge_are_seen_at_the_points_of_the_grid(library: Path) -> None:
    time = {"stop": "5 cycles", "step": {"per_cycle": 7}}
    plan = load("flapping-no-wing", None, library, time=time)
    times: list[float] = []

    class Times(Observer):
        def sample(self, view: View) -> None:
            times.append(view.time)

    done = run(plan, observers=[Times()])
    assert done.steps > plan.grid.count
    assert times == [plan.grid.point(k) for k in range(plan.grid.count + 1)]


def test_the_second_run_of_an_estimate_is_not_observed(library: Path) -> None:
    plan = load(SCENARIO, None, library, time=BRIEF)
    notes = Notes()
    done = run(plan, estimate=True, observers=[notes])
    assert done.estimates is not None
    assert notes.calls.count(("", "start")) == 1
    assert len(notes.times) == plan.grid.count + 1


def test_observers_are_called_in_their_order(library: Path) -> None:
    calls: list[tuple[str, str]] = []
    plan = load(SCENARIO, None, library, time={"stop": "1 cycles"})
    run(plan, observers=[Notes(calls, "a"), Notes(calls, "b")])
    assert calls[:4] == [("a", "start"), ("b", "start"), ("a", "sample"), ("b", "sample")]
    assert [name for name, _ in calls] == ["a", "b"] * (plan.grid.count + 2)


def test_an_exception_ends_the_run_and_keeps_the_rows(library: Path) -> None:
    after = Notes()
    plan = load(SCENARIO, None, library, time=BRIEF)
    done = run(plan, observers=[Notes(), Failing(30), after])
    assert isinstance(done.failure, ObserverError)
    assert isinstance(done.failure.__cause__, ValueError)
    assert str(done.failure) == (
        f"observers[1] (Failing): sample raised ValueError at t = {plan.grid.point(30):.9g} s:"
        " the disk is full"
    )
    assert done.times.tolist() == [plan.grid.point(k) for k in range(31)]
    assert after.steps == list(range(30))


def test_an_exception_with_a_tolerance_keeps_the_rows(library: Path) -> None:
    time = {**BRIEF, "tolerance": 1e-3}
    done = run(load(SCENARIO, None, library, time=time), observers=[Failing(0)])
    assert isinstance(done.failure, ObserverError)
    assert len(done.times) == 1


def test_an_exception_at_the_start_is_named(library: Path) -> None:
    done = run(load(SCENARIO, None, library, time=BRIEF), observers=[Failing(-1)])
    assert str(done.failure) == (
        "observers[0] (Failing): start raised RuntimeError at t = 0 s: no display"
    )


def test_a_misspelt_value_is_told_the_nearest(library: Path) -> None:
    class Misspelt(Observer):
        def sample(self, view: View) -> None:
            print(view["payload.displacment"])

    done = run(load(SCENARIO, None, library, time=BRIEF), observers=[Misspelt()])
    assert str(done.failure) == (
        "observers[0] (Misspelt): sample raised KeyError at t = 0 s: no wired or recorded output"
        " 'payload.displacment'; did you mean 'payload.displacement'?"
    )


def test_ctrl_c_inside_an_observer_ends_all(library: Path) -> None:
    class Stopped(Observer):
        def sample(self, view: View) -> None:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(load(SCENARIO, None, library, time=BRIEF), observers=[Stopped()])


def test_values_out_of_bounds_are_not_seen(library: Path) -> None:
    changes = {"payload.start_velocity": "9000", "spring.blocked_force": "0"}
    notes = Notes()
    done = run(load(SCENARIO, changes, library), observers=[notes])
    assert isinstance(done.failure, Divergence)
    assert notes.times == done.times.tolist()
    assert np.abs(notes.values).max() <= 1.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (Notes(), "observers: expected a list of observers, got one Notes"),
        ([print], "observers[0]: builtin_function_or_method has no method start and no sample"),
        ([Notes(), Notes], "observers[1]: Notes is a class; give an instance of it"),
    ],
)
def test_what_is_no_observer_is_refused_before_anything_is_loaded(
    library: Path, given: Any, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = load(SCENARIO, None, library, time=BRIEF)

    def never(*arguments: Any, **more: Any) -> None:
        raise AssertionError("loaded")

    monkeypatch.setattr("orchestrator.simulation.run.System", never)
    with pytest.raises(InputError) as caught:
        run(plan, observers=given)
    assert message in str(caught.value)


def test_without_observers_nothing_of_them_is_made(
    library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*arguments: Any) -> None:
        raise AssertionError("made")

    monkeypatch.setattr(observers_module, "View", never)
    plan = load(SCENARIO, None, library, time={"stop": "1 cycles"})
    assert run(plan).failure is None
    with pytest.raises(AssertionError, match="made"):
        run(plan, observers=[Notes()])
