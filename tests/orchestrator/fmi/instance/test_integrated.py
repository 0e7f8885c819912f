"""FMUs for model exchange as components: closed forms, events, rollback, errors."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrator.errors import FmuError
from orchestrator.fmi.description import read_interface
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.exchange import exchanged
from tests.foreign.scenarios import each_version, hold, part, scenario, wires

PLACES = (None, True, False)
"""Guarded with the whole loop, in a process of its own, in this process."""


def ran(path: Path, **options: object) -> Outcome:
    return run(load(str(path), **options), estimate=False).checked()


@each_version
@pytest.mark.parametrize("isolate", PLACES, ids=["guarded", "isolated", "here"])
def test_a_decay_is_that_of_the_closed_form(
    tmp_path: Path, version: int, isolate: bool | None
) -> None:
    """x' = u - k x with u held, at the tolerance of CVODE whatever the communication step."""
    fmu = exchanged("DECAY", tmp_path, version)
    text = part("decay", fmu, start={"k": 3.0, "x_start": 2.0}, isolate=isolate)
    path = scenario(tmp_path, text, hold({"decay.u": 1.5}), stop=2.0, step=0.1)
    found = ran(path)
    exact = 0.5 + 1.5 * np.exp(-3.0 * found.times)
    assert np.abs(found.series("decay.x") - exact).max() < 1e-6


@each_version
def test_van_der_pol_by_the_tolerance(
    tmp_path: Path, version: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its fast turns make much of an error; a thousandth of the tolerance makes a tenth of it."""
    errors = []
    for tolerance in (1e-6, 1e-9):
        monkeypatch.setattr("orchestrator.fmi.instance.integrated.TOLERANCE", tolerance)
        errors.append(van_der_pol(tmp_path, version))
    assert errors[1] < 1e-4
    assert errors[1] < 0.1 * errors[0]


def van_der_pol(tmp_path: Path, version: int) -> float:
    fmu = exchanged("VAN_DER_POL", tmp_path, version)
    text = part("oscillator", fmu, start={"mu": 5.0}, isolate=False)
    found = ran(scenario(tmp_path, text, stop=10.0, step=0.05))

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [y[1], 5.0 * (1.0 - y[0] ** 2) * y[1] - y[0]]

    exact = solve_ivp(rates, (0.0, 10.0), [2.0, 0.0], "LSODA", found.times, rtol=1e-11, atol=1e-12)
    return float(np.abs(found.series("oscillator.x") - exact.y[0]).max())


@each_version
def test_a_ball_bounces_at_its_times(tmp_path: Path, version: int) -> None:
    """Between two communication points, and where one of them is far behind the bounce."""
    fmu = exchanged("BALL", tmp_path, version)
    found = ran(scenario(tmp_path, part("ball", fmu), stop=2.0, step=0.07))
    fall = math.sqrt(2.0 / 9.81)
    bounces, height = [fall], []
    for k in range(20):
        bounces.append(bounces[-1] + 2.0 * fall * 0.7 ** (k + 1))
    for t in found.times:
        n = sum(at <= t for at in bounces)
        if n == 0:
            height.append(1.0 - 0.5 * 9.81 * t * t)
        else:
            since = t - bounces[n - 1]
            height.append(9.81 * fall * 0.7**n * since - 0.5 * 9.81 * since * since)
    counted = [sum(at <= t for at in bounces) for t in found.times]
    assert np.abs(found.series("ball.height") - height).max() < 1e-6
    assert found.series("ball.bounces").tolist() == counted


def test_a_ball_that_bounces_without_end_is_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All bounces are over at 2.56 s; rows up to that step are kept."""
    monkeypatch.setattr("orchestrator.fmi.instance.integrated.MOST_STOPS", 200)
    fmu = exchanged("BALL", tmp_path)
    path = scenario(tmp_path, part("ball", fmu, isolate=False), stop=3.0, step=0.1)
    found = run(load(str(path)), estimate=False)
    assert "more than 200 events up to t = 2.558" in str(found.failure)
    assert found.times[-1] == pytest.approx(2.5)


@each_version
def test_time_events_are_stepped_to(tmp_path: Path, version: int) -> None:
    fmu = exchanged("CLOCK", tmp_path, version)
    found = ran(scenario(tmp_path, part("clock", fmu), stop=2.0, step=0.1))
    assert found.series("clock.n").tolist() == np.floor((found.times + 1e-9) / 0.25).tolist()


@each_version
@pytest.mark.parametrize(
    ("master", "least"), [("gauss-seidel", 5e-2), ("extrapolated", 3e-3), ("iterative", 3e-3)]
)
def test_two_masses_on_an_algebraic_force(
    tmp_path: Path, version: int, master: str, least: float
) -> None:
    """Two masses and the spring between them, all for model exchange; finer steps are better."""
    errors = []
    for step in (0.02, 0.01):
        folder = tmp_path / f"{step}"
        folder.mkdir()
        errors.append(deviation(folder, version, master, step))
    assert errors[0] < least
    assert errors[1] < 0.6 * errors[0]


def test_an_algebraic_force_to_a_millionth(tmp_path: Path) -> None:
    assert deviation(tmp_path, 2, "extrapolated", 5e-4) < 1e-6


def test_steps_by_a_tolerance_go_back(tmp_path: Path) -> None:
    """Rejected steps are undone by the FMUs' own states, and CVODE starts anew."""
    assert deviation(tmp_path, 2, "extrapolated", 0.01, tolerance=1e-4) < 1e-2


@each_version
@pytest.mark.parametrize("master", ["extrapolated", "iterative"])
def test_without_states_it_goes_back_by_its_continuous_ones(
    tmp_path: Path, version: int, master: str
) -> None:
    """By a tolerance, and by passes: the same rows as with the FMU's own states."""
    rows = []
    for rollback in (True, False):
        (tmp_path / str(rollback)).mkdir()
        given = {"tolerance": 1e-4} if master == "extrapolated" else {}
        rows.append(
            deviation(tmp_path / str(rollback), version, master, 0.01, rollback=rollback, **given)
        )
    assert rows[0] == pytest.approx(rows[1], rel=1e-9)
    assert rows[1] < 1e-2


def test_an_event_cannot_be_undone_by_continuous_states(tmp_path: Path) -> None:
    fmu = exchanged("BALL", tmp_path, rollback=False)
    text = part("ball", fmu, isolate=False)
    path = scenario(tmp_path, text, stop=1.0, step=0.1)
    done = run(load(str(path), time={"tolerance": 1e-9}), estimate=False)
    assert "an event lies in the step that is to be undone" in str(done.failure)
    assert "rollback = false" in str(done.failure)


def deviation(
    folder: Path, version: int, master: str, step: float, *, rollback: bool = True, **time: float
) -> float:
    """Largest error of both positions over the closed form, by the amplitude of 1."""
    mass, spring = (exchanged(name, folder, version, rollback) for name in ("MASS", "SPRING"))
    path = scenario(
        folder,
        f'[master]\nkind = "{master}"',
        part("a", mass, start={"x_start": 1.0}),
        part("b", mass),
        part("spring", spring, start={"k": 2.0, "ground": 3.0}),
        wires(
            "a.x -> spring.x1", "a.v -> spring.v1", "b.x -> spring.x2", "b.v -> spring.v2",
            "spring.f1 -> a.f", "spring.f2 -> b.f",
        ),
        stop=1.5,
        step=step,
    )  # fmt: skip
    found = ran(path, time=time) if time else ran(path)
    slow, fast = np.cos(math.sqrt(3.0) * found.times), np.cos(math.sqrt(7.0) * found.times)
    exact = 0.5 * (slow + fast), 0.5 * (slow - fast)
    return float(
        max(np.abs(found.series(f"{n}.x") - x).max() for n, x in zip("ab", exact, strict=True))
    )


def test_both_loops_give_the_same_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fmu = exchanged("BALL", tmp_path)
    path = scenario(tmp_path, part("ball", fmu, isolate=False), stop=1.0, step=0.07)
    compiled = ran(path)
    monkeypatch.setattr("orchestrator.simulation.compiled.drive.missing", lambda: "left out")
    python = ran(path)
    assert python.python_loop and not compiled.python_loop
    assert np.array_equal(compiled.rows, python.rows)


@each_version
def test_what_is_for_model_exchange_is_seen(tmp_path: Path, version: int) -> None:
    interface = read_interface(exchanged("BALL", tmp_path, version))
    assert interface.model_exchange
    assert interface.variable_step
    assert interface.rollback


def test_without_a_solver_the_way_out_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "fmpy.sundials", None)
    fmu = exchanged("DECAY", tmp_path)
    text = part("decay", fmu, isolate=False)
    path = scenario(tmp_path, text, hold({"decay.u": 0.0}))
    with pytest.raises(
        FmuError, match=r"fmpy has no CVODE for this .* export it for co-simulation"
    ):
        run(load(str(path)), estimate=False)
