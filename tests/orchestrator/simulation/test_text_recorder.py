"""Texts of FMUs in a result: where they come from, where they are kept, what cannot be done."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import InputError, InstanceFailure, ScenarioError
from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset, folder_of, recover, segments_for, write
from orchestrator.results.outcome import Outcome
from orchestrator.results.plot import draw
from orchestrator.results.recorded import read_recorded, recorded
from orchestrator.scenario.inspection import facts
from orchestrator.simulation.load import load
from orchestrator.simulation.observers import Recorder
from orchestrator.simulation.run import run
from tests.foreign.scenarios import (
    Shelf,
    Value,
    each_version,
    hold,
    level_control,
    part,
    ran,
    scenario,
)

pytestmark = pytest.mark.usefixtures("mark")
RECORD = '[record]\nvariables = ["relay.open", "relay.state"]'
PLACES = pytest.mark.parametrize(
    "keys", [{}, {"isolate": True}, {"isolate": False}], ids=["guarded", "isolated", "in process"]
)


def in_words(opened: object) -> list[str]:
    return ["geöffnet" if each else "zu" for each in np.asarray(opened)]


def shown(outcome: Outcome) -> None:
    """The text says at each row what the Boolean beside it says, and both have changed."""
    words = outcome.series("relay.state")
    assert set(words) == {"geöffnet", "zu"}
    assert list(words) == in_words(outcome.series("relay.open"))


@PLACES
@each_version
def test_a_text_is_recorded_over_time(
    version: int, keys: dict[str, Value], shelf: Shelf, tmp_path: Path
) -> None:
    path = level_control(tmp_path, shelf, RECORD, version=version, **keys)
    outcome = ran(path)
    shown(outcome)
    assert outcome.python_loop == "texts are recorded in Python"
    times = [time for time, _ in outcome.texts["relay.state"]]
    assert times[0] == 0.0
    assert len(times) == 1 + np.count_nonzero(np.diff(outcome.series("relay.open")))
    written = write(outcome, tmp_path / "out.nc")
    with xarray.open_dataset(written) as data:
        assert list(data["relay.state"].values) == list(outcome.series("relay.state"))
        assert data["relay.state"].dims == ("time",)
        assert data["relay.state"].attrs == {"long_name": "The valve in words"}
    assert list(dataset(outcome)["relay.state"].values) == list(outcome.series("relay.state"))


def test_rows_beside_a_text_are_those_without(shelf: Shelf, tmp_path: Path) -> None:
    plain = ran(level_control(tmp_path, shelf))
    text = ran(level_control(tmp_path, shelf, '[record]\nvariables = ["*", "relay.state"]'))
    assert text.names == plain.names
    assert text.rows.tobytes() == plain.rows.tobytes()


def test_rejected_steps_leave_no_text(shelf: Shelf, tmp_path: Path) -> None:
    outcome = ran(level_control(tmp_path, shelf, RECORD, step=0.1, more="tolerance = 1e-4"))
    assert outcome.rejected
    shown(outcome)


@each_version
def test_parameters_and_starts_are_texts_too(version: int, shelf: Shelf, tmp_path: Path) -> None:
    """What a pattern stands for does not include texts; one is named whole."""
    path = scenario(
        tmp_path,
        part("relay", shelf("RELAY", version)),
        part("a", shelf("DECAY", version), start={"table": "Größe.csv"}),
        hold({"relay.level": 0.0}),
        '[record]\nvariables = ["a.table", "a.x", "relay.*"]',
        "[metrics]\nx = 'last(a.x)'",
    )
    plan = load(path)
    assert plan.text_names == ["a.table"]
    assert facts(plan)["records"] == [*plan.record_names, "a.table"]
    outcome = run(plan, estimate=True)
    assert list(outcome.series("a.table")) == ["Größe.csv"] * 11
    assert outcome.estimates and outcome.metric_errors
    assert [metric.name for metric in metrics(outcome)] == ["x"]


def test_a_crash_keeps_the_texts_before_it(shelf: Shelf, tmp_path: Path) -> None:
    faulty = part("faulty", shelf("FAULTY", 2), start={"fault": 1, "fault_time": 3.0})
    held = hold({"faulty.u": 0.0})
    outcome = run(load(level_control(tmp_path, shelf, RECORD, faulty, held)))
    assert isinstance(outcome.failure, InstanceFailure)
    assert len(outcome.times) == 300
    shown(outcome)


def test_texts_of_closed_segments_are_recovered(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Recorder, "SEGMENT", 1)
    plan = load(level_control(tmp_path, shelf, RECORD, isolate=False))
    target = tmp_path / "long.nc"
    segments = segments_for(plan, target)
    run(plan, segments=segments, estimate=False)
    segments.lock.release()
    found, rows, _ = recover(folder_of(target))
    assert rows == 256
    with xarray.open_dataset(found) as data:
        assert list(data["relay.state"].values) == in_words(data["relay.open"].values)


def test_segments_of_a_guarded_run_hold_its_texts(shelf: Shelf, tmp_path: Path) -> None:
    plan = load(level_control(tmp_path, shelf, RECORD))
    outcome = run(plan, segments=segments_for(plan, tmp_path / "out.nc"), estimate=False)
    shown(outcome)


def test_texts_are_neither_drawn_nor_counted(shelf: Shelf, tmp_path: Path) -> None:
    outcome = ran(level_control(tmp_path, shelf, RECORD))
    written = write(outcome, tmp_path / "out.nc")
    with xarray.open_dataset(written) as data:
        for source in (outcome, read_recorded(written), data):
            known = recorded(source)
            assert list(known.series) == ["relay.open"]
            assert known.texts == {"relay.state": outcome.texts["relay.state"]}
            with pytest.raises(InputError, match=r"'relay\.state': is a text, of which there is"):
                draw(source, tmp_path / "out.png", ["relay.state"])
            draw(source, tmp_path / "out.png")
    path = level_control(tmp_path, shelf, RECORD, "[metrics]\nlast = 'last(relay.state)'")
    with pytest.raises(ScenarioError, match=r"relay\.state is a String; metrics are of numbers"):
        load(path)
