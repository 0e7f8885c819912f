"""A quarter car and a level control of foreign FMUs, by a tolerance alone, against closed forms.

`-s` prints steps, calls, time, true error and estimate.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.scenarios import Shelf, level_control, quarter_car

Values = NDArray[np.float64]


def controlled(path: Path, tolerance: float) -> Outcome:
    """A run by a tolerance alone: no step, no frequency, no master."""
    lines = [line for line in path.read_text().split("\n") if not line.startswith("step =")]
    path.write_text("\n".join(lines))
    return run(load(path, time={"tolerance": tolerance}), estimate=True).checked()


def car(times: Values) -> dict[str, Values]:
    """Displacements of body and wheel: a linear system of four states."""
    body, wheel, spring, damper, tyre = 300.0, 40.0, 2e4, 1.5e3, 1.8e5
    system = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-spring / body, -damper / body, spring / body, damper / body],
            [0.0, 0.0, 0.0, 1.0],
            [spring / wheel, damper / wheel, -(spring + tyre) / wheel, -damper / wheel],
        ]
    )
    states = np.array([expm(system * time) @ [0.05, 0.0, 0.0, 0.0] for time in times])
    return {"body.displacement": states[:, 0], "wheel.displacement": states[:, 2]}


def level(times: Values) -> dict[str, Values]:
    """Level of the tank: exponentials to 1 and to 0 in turn, from bound to bound."""
    time, height, goal = 0.0, 0.0, 1.0
    ends, pieces = [time], []
    while time <= times[-1]:
        bound = 0.6 if goal else 0.4
        pieces.append((time, height, goal))
        time += float(np.log((height - goal) / (bound - goal)))
        height, goal = bound, 1.0 - goal
        ends.append(time)
    values = np.zeros(len(times))
    for (begin, end), (start, first, rest) in zip(pairwise(ends), pieces, strict=True):
        inside = (times >= begin) & (times <= end)
        values[inside] = rest + (first - rest) * np.exp(-(times[inside] - start))
    return {"tank.level": values}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(
    ("system", "exact", "tolerance", "calls", "error"),
    [
        (quarter_car, car, 1e-3, 500, 2e-3),
        (quarter_car, car, 1e-4, 1000, 5e-4),
        (quarter_car, car, 1e-6, 4500, 2e-5),
        (level_control, level, 1e-3, 600, 3e-3),
        (level_control, level, 1e-4, 800, 6e-4),
        (level_control, level, 1e-6, 1200, 1e-5),
    ],
)
def test_a_tolerance_is_kept_and_the_error_is_said(
    system: Callable[..., Path],
    exact: Callable[[Values], dict[str, Values]],
    tolerance: float,
    calls: int,
    error: float,
    version: int,
    shelf: Shelf,
    tmp_path: Path,
) -> None:
    """The level is estimated a little low: a switch is late by a part of a step, at both steps."""
    done = controlled(system(tmp_path, shelf, version=version), tolerance)
    assert done.estimates is not None
    true, said = 0.0, 0.0
    for name, values in exact(done.times).items():
        true = max(true, float(np.abs(done.series(name) - values).max() / np.abs(values).max()))
        said = max(said, done.estimates[name].relative)
    print(
        f"{system.__name__} {tolerance:g}: {done.steps} steps, {done.rejected} rejected,"
        f" {1e3 * done.wall_time:.1f} ms, true error {true:.1e}, estimated {said:.1e}"
    )
    assert max(done.calls.values()) < calls
    assert true < error
    assert 0.25 < said / true < 3.0


@pytest.mark.parametrize(
    "kind", ["gauss-seidel", "jacobi", "extrapolated", "iterative", "interface-newton"]
)
def test_at_a_fixed_step_a_switch_is_a_step_late_and_the_run_says_so(
    kind: str, shelf: Shelf, tmp_path: Path
) -> None:
    """No master waits for a fixed point that a two-point controller may not have."""
    done = run(load(level_control(tmp_path, shelf), master={"kind": kind}), estimate=True).checked()
    late = 3.0 if kind == "jacobi" else 2.0
    assert done.series("tank.level").max() < 0.6 + late * 0.01
    assert re.match(r"switches [78] times, each up to a step late", done.unseen["relay.open"])


@pytest.mark.parametrize("reverse", [False, True])
def test_what_decides_steps_last(reverse: bool, shelf: Shelf, tmp_path: Path) -> None:
    """Whatever the order of the file: the relay sees the level at the end of the same step."""
    path = level_control(tmp_path, shelf)
    if reverse:
        head, tank, relay = path.read_text().partition("[components.tank]")[0], "", ""
        rest = path.read_text()[len(head) :]
        tank, _, tail = rest.partition("[components.relay]")
        relay, _, tail = tail.partition("[[wires]]")
        path.write_text(f"{head}[components.relay]{relay}{tank}\n[[wires]]{tail}")
    plan = load(path)
    assert plan.order == ["tank", "relay"]
    done = run(plan, estimate=False).checked()
    assert done.series("tank.level").max() < 0.6 + 0.01
