"""What a run says of its own error, what it cannot see, and when it says it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.results.accuracy import (
    INACCURATE,
    largest_error,
    meaningless,
    remedy,
    still,
)
from orchestrator.results.error_estimate import BEYOND, estimate, halved, with_estimates
from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset
from orchestrator.results.outcome import Estimate, Outcome
from orchestrator.results.summary import warnings
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.conftest import Runner
from tests.foreign.scenarios import Shelf, populations

SHORT = {"stop": "8 cycles", "step": {"per_cycle": 40}}


@pytest.fixture(scope="module")
def oscillator(library: Path) -> Outcome:
    """A short run with its estimate."""
    return run(load("oscillator-1", None, library, time=SHORT), estimate=True)


def test_the_error_is_relative_to_the_largest_of_both() -> None:
    """A run that has blown up does not make its own error look small, nor one that stands still."""
    still, moving = np.zeros(5), np.linspace(0.0, 2.0, 5)
    assert estimate(still, moving) == Estimate(BEYOND * 2.0, BEYOND)
    assert estimate(moving, still).relative == BEYOND
    assert estimate(still, still) == Estimate(0.0, 0.0)


def test_each_step_is_halved() -> None:
    assert halved([0.0, 1.0, 4.0]) == [0.0, 0.5, 1.0, 2.5, 4.0]


def test_metrics_carry_an_error_that_holds_the_finer_value(
    oscillator: Outcome, library: Path
) -> None:
    fine = run(load("oscillator-1", None, library, time={**SHORT, "step": {"per_cycle": 640}}))
    better = {m.name: m.value for m in metrics(fine)}
    for metric in metrics(oscillator):
        if metric.name in ("travel", "phase", "peak voltage"):
            assert metric.error is not None
            assert 0.0 < abs(metric.value - better[metric.name]) < 3.0 * metric.error
            assert metric.shown_error.split()[1:] == metric.shown.split()[1:]


def test_a_file_carries_the_errors(oscillator: Outcome) -> None:
    data = dataset(oscillator)
    assert data.attrs["error_estimate"] == "half step"
    assert json.loads(data.attrs["metric_errors"]) == oscillator.metric_errors
    assert [m.error for m in metrics(data)] == [m.error for m in metrics(oscillator)]
    assert data["payload.displacement"].attrs["estimated_error"] > 0.0


def test_a_quick_run_is_estimated_unasked(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = load("oscillator-1", None, library, time=SHORT)
    assert "ask with --estimate" in run(plan).doubt
    monkeypatch.setattr("orchestrator.simulation.run.BUDGET", 600.0)
    assert run(plan).estimates is not None
    none = run(plan, estimate=False)
    assert none.estimates is None and none.doubt == ""


@pytest.mark.parametrize(
    ("options", "named_option"),
    [
        ({"time": {"step": {"per_cycle": 20}}}, "per cycle"),
        ({"time": {"step": "1 ms"}}, " s"),
        ({"time": {"tolerance": 0.3}}, "--tolerance"),
    ],
)
def test_an_inaccurate_run_names_the_setting_that_would_do(
    library: Path, options: dict[str, dict[str, object]], named_option: str
) -> None:
    """The setting that is named brings the error below the bound of the warning."""
    options["master"] = {"laws": "held"}
    options["time"].setdefault("stop", "8 cycles")
    done = run(load("oscillator-1", None, library, **options), estimate=True)
    found = [w for w in warnings(done) if w.kind == "estimated error"]
    assert len(found) == 1
    assert found[0].figure == largest_error(done)[1] > INACCURATE
    assert named_option in found[0].text
    named = found[0].text.partition("; --")[2].removesuffix(" would do")
    option, _, value = named.partition(" ")
    value = value.strip('"')
    time = dict(options["time"])
    if option == "tolerance":
        time["tolerance"] = float(value)
    else:
        time["step"] = {"per_cycle": int(value.split()[0])} if "per" in value else value
    again = run(load("oscillator-1", None, library, **{**options, "time": time}), estimate=True)
    assert largest_error(again)[1] < 1.5 * INACCURATE


def test_numbers_that_say_nothing_name_a_step_where_an_order_is_seen(library: Path) -> None:
    options: dict[str, Any] = {"master": {"laws": "held"}}
    time = {"stop": "8 cycles", "step": {"per_cycle": 8}}
    done = run(load("oscillator-1", None, library, time=time, **options), estimate=True)
    _, named, after = meaningless(done).partition('--step "')
    assert named
    time["step"] = {"per_cycle": int(after.split()[0])}
    again = run(load("oscillator-1", None, library, time=time, **options), estimate=True)
    assert largest_error(again)[1] < INACCURATE
    assert remedy(done.plan, 1.2) == "--step auto finds one that would do"
    assert "per cycle" in remedy(replace(done.plan, step_reason="found by trials"), 1.2)


def test_numbers_that_say_nothing_leave_with_an_error(
    shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Prey and predators, one number each way: no energy to audit, and a step far too long."""
    path = populations(tmp_path, shelf, '[master]\nkind = "gauss-seidel"', step=0.1)
    monkeypatch.setattr("orchestrator.simulation.run.BUDGET", 600.0)
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["run", str(path), "--no-picture"])
    assert done.exit_code == 1, done.output
    assert "these numbers say nothing" in done.output
    assert (tmp_path / "results" / "scenario.nc").is_file()
    bare = CliRunner().invoke(app, ["run", str(path), "--no-picture", "--no-estimate"])
    assert bare.exit_code == 0, bare.output


@pytest.mark.parametrize(
    ("kind", "reason"),
    [("Boolean", "each up to a step late"), ("Int32", "it switches at another time")],
)
def test_switches_are_not_estimated(oscillator: Outcome, kind: str, reason: str) -> None:
    """A number that is no measure gets none, and the reason."""
    first = oscillator.plan.records[0][1]
    records = [
        (c, replace(v, kind=kind) if v.name == first.name else v)
        for c, v in oscillator.plan.records
    ]
    plan = replace(oscillator.plan, records=records)
    mine = replace(oscillator, plan=plan, estimates=None)
    other = replace(mine, rows=np.where(np.arange(len(mine.rows))[:, None] % 2, 0.0, mine.rows))
    found = with_estimates(mine, other)
    name = oscillator.names[0]
    assert found.estimates is not None and name not in found.estimates
    assert reason in found.unseen[name]


def test_a_unit_with_a_step_of_its_own_is_named(
    oscillator: Outcome, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Outputs that change at every fourth half step: halving the step does not show their error."""
    stairs = np.repeat(oscillator.rows[::4], 4, axis=0)[: len(oscillator.rows)]
    foreign = {n: replace(i, ours=False) for n, i in oscillator.plan.interfaces.items()}
    plan = replace(oscillator.plan, interfaces=foreign)
    mine = replace(oscillator, plan=plan, rows=stairs)
    found = with_estimates(mine, mine)
    assert "every 4th of the half steps" in found.unseen["payload"]
    assert [w.place for w in warnings(found) if w.kind == "not estimated"]
    own = replace(mine, plan=oscillator.plan)
    assert with_estimates(own, own).unseen == {}


def test_what_does_not_move_is_said_first(outcome: Runner) -> None:
    """Two bipolar sines pull alike on both cones: nothing moves, which is right and no error."""
    done = outcome(
        "flapping-spring-full-wings", {"amplifier.waveform": "sine"}, time={"stop": "2 cycles"}
    )
    first = next(warnings(done))
    assert first.kind == "still" and first.place == "linkage.displacement"
    assert meaningless(done) == ""
    assert set(still(done)) == {"linkage.displacement", "linkage.flap_angle"}


def test_outputs_that_freeze_are_said(
    oscillator: Outcome, tmp_path: Path, shelf: Callable[..., Path]
) -> None:
    frozen = np.tile(oscillator.rows[1], (len(oscillator.rows), 1))
    frozen[0] = oscillator.rows[0] - 1.0
    foreign = {n: replace(i, ours=False) for n, i in oscillator.plan.interfaces.items()}
    done = replace(oscillator, rows=frozen, plan=replace(oscillator.plan, interfaces=foreign))
    found = {w.place for w in warnings(done) if "never change again" in w.text}
    assert found == {"amplifier", "spring", "payload"}
