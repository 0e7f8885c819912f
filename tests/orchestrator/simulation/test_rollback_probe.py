"""FMUs that say that they can go back, and do not: refused where anything would rely on it."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import InitialisationError, InstanceFailure
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.scenarios import (
    Shelf,
    Value,
    each_version,
    faulty,
    hold,
    part,
    ran,
    scenario,
)

CHANGES = pytest.mark.parametrize(
    "changes",
    [
        {"master": {"kind": "iterative"}},
        {"master": {"kind": "interface-newton"}},
        {"time": {"tolerance": 1e-3}},
    ],
    ids=["iterative", "interface-newton", "tolerance"],
)


def fed(folder: Path, shelf: Shelf, version: int, *, forgetful: bool, **keys: bool) -> Path:
    """A mass that is pushed by a decaying value."""
    return scenario(
        folder,
        part("source", shelf("DECAY", version)),
        part("mass", shelf("MASS", version, forgetful=forgetful), **keys),
        hold({"mass.force": 1.0}),
        stop=0.5,
    )


@CHANGES
@each_version
def test_a_forgetful_fmu_is_refused_with_the_way_out(
    version: int, changes: dict[str, dict[str, object]], shelf: Shelf, tmp_path: Path
) -> None:
    path = fed(tmp_path, shelf, version, forgetful=True)
    with pytest.raises(InitialisationError) as error:
        run(load(path, **changes))
    text = str(error.value)
    assert text.startswith(f"{path}: components.mass: its FMU says that it can go back")
    assert "rollback = false" in text


@CHANGES
def test_nothing_is_changed_for_one_that_goes_back(
    changes: dict[str, dict[str, object]],
    shelf: Shelf,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = fed(tmp_path, shelf, 2, forgetful=False, isolate=False)
    probed = ran(path, **changes)
    monkeypatch.setattr("orchestrator.simulation.run.check_rollback", lambda *given: None)
    bare = ran(path, **changes)
    assert probed.rows.tobytes() == bare.rows.tobytes()
    assert (probed.calls, probed.rollbacks) == (bare.calls, bare.rollbacks)


def test_without_its_rollback_a_forgetful_fmu_runs(shelf: Shelf, tmp_path: Path) -> None:
    """Steps by a tolerance are then taken by foresight: half of t squared, within it."""
    path = fed(tmp_path, shelf, 2, forgetful=True, rollback=False)
    outcome = ran(path, time={"tolerance": 1e-3})
    assert outcome.series("mass.displacement")[-1] == pytest.approx(0.125, rel=1e-2)
    assert outcome.rollbacks["mass"] == 0
    ran(fed(tmp_path, shelf, 2, forgetful=True), master={"kind": "gauss-seidel"})


@pytest.mark.usefixtures("mark")
@pytest.mark.parametrize(
    ("fault", "changes", "keys"),
    [
        (1, {"master": {"kind": "iterative"}}, {}),
        (1, {"master": {"kind": "iterative"}}, {"isolate": True}),
        (10, {"master": {"kind": "interface-newton"}}, {}),
        (10, {"master": {"kind": "iterative"}}, {"isolate": False}),
    ],
    ids=["guarded", "isolated", "fatal", "fatal in process"],
)
def test_a_crash_in_the_trial_costs_no_row(
    fault: int,
    changes: dict[str, dict[str, object]],
    keys: dict[str, Value],
    shelf: Shelf,
    tmp_path: Path,
) -> None:
    """An FMU whose outputs rest is tried over steps that the run has yet to take."""
    path = faulty(tmp_path, shelf("FAULTY", 2), fault, held={"faulty.u": 0.0}, **keys)
    outcome = run(load(path, **changes))
    assert isinstance(outcome.failure, InstanceFailure)
    assert outcome.failure.exit_code == 1
    assert "faulty: step from t = " in str(outcome.failure)
    assert outcome.times.tolist() == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])
