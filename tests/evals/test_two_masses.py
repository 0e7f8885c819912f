"""Every master on two masses: order, error, stiff couplings, adaptive steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import Divergence
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import MASTERS
from orchestrator.simulation.run import run
from tests.evals.two_masses import exact, scenarios

KINDS = sorted(MASTERS)
SECOND = ("extrapolated", "interface-newton", "iterative")
X = "first.displacement"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return scenarios(tmp_path_factory.mktemp("two"))


def solved(folder: Path, library: Path, scenario: str, kind: str, stiffness: float = 1.0,
           **time: object) -> Outcome:  # fmt: skip
    changes = {"pair.stiffness": str(stiffness)}
    path = folder / f"{scenario}.toml"
    plan = load(path, changes, library, time=time, master={"kind": kind})
    return run(plan, estimate="tolerance" in time)


def miss(outcome: Outcome, stiffness: float = 1.0) -> float:
    return float(np.abs(outcome.series(X) - exact(outcome.times, stiffness)).max())


@pytest.mark.parametrize("kind", KINDS)
def test_order_with_bare_numbers(folder: Path, library: Path, kind: str) -> None:
    coarse, fine = (miss(solved(folder, library, "numbers", kind, step=h)) for h in (1e-2, 2.5e-3))
    order = np.log2(coarse / fine) / 2.0
    if kind in SECOND:
        assert 1.95 < order < 2.05
        assert coarse < 5e-4
    else:
        assert 0.95 < order < 1.1
        assert coarse < 5e-2


@pytest.mark.parametrize("kind", KINDS)
def test_order_with_laws(folder: Path, library: Path, kind: str) -> None:
    coarse, fine = (miss(solved(folder, library, "laws", kind, step=h)) for h in (2e-2, 5e-3))
    assert 1.95 < np.log2(coarse / fine) / 2.0 < 2.1
    assert fine < 2e-5


def test_laws_beat_extrapolation_beats_held(folder: Path, library: Path) -> None:
    laws = miss(solved(folder, library, "laws", "gauss-seidel", step=1e-2))
    carried = miss(solved(folder, library, "numbers", "extrapolated", step=1e-2))
    held = miss(solved(folder, library, "numbers", "gauss-seidel", step=1e-2))
    assert laws < 0.2 * carried < 0.01 * held


@pytest.mark.parametrize("degree", [2, 3])
def test_higher_degrees_lower_the_error(folder: Path, library: Path, degree: int) -> None:
    path = folder / "numbers.toml"
    master = {"kind": "extrapolated", "degree": degree}
    done = run(load(path, None, library, master=master))
    assert miss(done) < 0.5 * miss(solved(folder, library, "numbers", "extrapolated"))


@pytest.mark.parametrize("stiffness", [10.0, 1000.0])
@pytest.mark.parametrize("kind", KINDS)
def test_stiff_couplings_are_bounded_or_stopped(
    folder: Path, library: Path, kind: str, stiffness: float
) -> None:
    """Stopped within 100 steps of leaving ten times the true peak, which is 1."""
    done = solved(folder, library, "numbers", kind, stiffness)
    beyond = np.flatnonzero(np.abs(done.series(X)) > 10.0)
    if len(beyond):
        assert isinstance(done.failure, Divergence)
        assert len(done.times) - beyond[0] < 100
    else:
        assert done.failure is None or isinstance(done.failure, Divergence)


@pytest.mark.parametrize("kind", ["jacobi", "extrapolated"])
def test_a_coupling_that_feeds_a_growth_is_named(folder: Path, library: Path, kind: str) -> None:
    done = solved(folder, library, "numbers", kind, 1000.0)
    assert isinstance(done.failure, Divergence)
    assert "pair.first -> first.force creates energy" in str(done.failure)


def test_interface_newton_is_bounded_where_passes_are_not(folder: Path, library: Path) -> None:
    """h w = 8 with w^2 = 1 + 2 k, h = 1e-2."""
    stiffness = 0.5 * (800.0**2 - 1.0)
    newton = solved(folder, library, "numbers", "interface-newton", stiffness)
    assert newton.failure is None
    assert np.abs(newton.series(X)).max() <= 1.001
    passes = solved(folder, library, "numbers", "iterative", stiffness)
    assert "does not settle" in str(passes.failure)


@pytest.mark.parametrize("acceleration", ["relaxed", "aitken", "anderson"])
def test_acceleration_converges_where_plain_passes_do_not(
    folder: Path, library: Path, acceleration: str
) -> None:
    """h w = 2.4: the gain of a plain pass is above one."""
    stiffness = 0.5 * (240.0**2 - 1.0)
    base = {"kind": "iterative", "passes": 200}
    changes = {"pair.stiffness": str(stiffness)}
    time = {"stop": 0.5}
    path = folder / "numbers.toml"
    plain = run(load(path, changes, library, time=time, master=base))
    assert "does not settle" in str(plain.failure)
    helped = run(
        load(path, changes, library, time=time, master={**base, "acceleration": acceleration})
    )
    assert helped.failure is None
    newton = run(load(path, changes, library, time=time, master={"kind": "interface-newton"}))
    assert helped.series(X) == pytest.approx(newton.series(X), abs=1e-6)


@pytest.mark.parametrize("scenario", ["numbers", "laws"])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_the_estimate_is_the_error(
    folder: Path, library: Path, scenario: str, tolerance: float
) -> None:
    kind = "gauss-seidel" if scenario == "laws" else "extrapolated"
    done = solved(folder, library, scenario, kind, tolerance=tolerance, stop=5.0)
    assert done.failure is None
    assert done.estimates is not None
    assert 1.0 / 3.0 < done.estimates[X].error / miss(done) < 3.0
    assert miss(done) < 30.0 * tolerance, "without a cycle it bounds each step, and steps add up"


def test_steps_adapt_without_rollback(tmp_path: Path, library: Path) -> None:
    """The error is that of an extrapolation; no step can be taken back."""
    folder = scenarios(tmp_path, rollback=False)
    errors = []
    for tolerance in (1e-3, 1e-5):
        done = solved(folder, library, "numbers", "extrapolated", tolerance=tolerance, stop=5.0)
        assert done.failure is None
        assert done.rejected == 0
        assert sum(done.rollbacks.values()) == 0
        assert done.estimates is not None
        assert 1.0 / 3.0 < done.estimates[X].error / miss(done) < 3.0
        errors.append(miss(done))
    assert errors[1] < 0.05 * errors[0]


def test_the_audit_counts_what_held_forces_create(folder: Path, library: Path) -> None:
    """Energy of the oscillators at the end, from motion alone, against the sum of the audit."""
    path = folder / "numbers.toml"
    record = {"variables": ["*.displacement", "*.velocity"]}
    done = run(load(path, None, library, record=record, master={"kind": "gauss-seidel"}))
    x, y = done.series(X), done.series("second.displacement")
    v, w = done.series("first.velocity"), done.series("second.velocity")
    energy = 0.5 * (v**2 + w**2 + x**2 + y**2 + (x - y) ** 2)
    created = sum(made for made, _ in done.couplings.values())
    assert created == pytest.approx(energy[-1] - energy[0], rel=0.02)
    assert created > 0.01
