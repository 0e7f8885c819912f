"""Every run says how wrong it is: estimated over true error, over all scenarios and random ones.

The true error is the distance from the same run at a sixteenth of its step. `-s` prints a line for
each run: true error, estimated error, their ratio, warnings.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from orchestrator.results.accuracy import INACCURATE, largest_error, meaningless
from orchestrator.results.outcome import Outcome
from orchestrator.results.summary import warnings
from orchestrator.scenario.files import scenario_names
from orchestrator.scenario.plan import Plan
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.precision.method import own, with_step
from orchestrator.studies.reference.solution import errors
from tests.foreign.scenarios import Shelf, masses, populations, ring

QUICK = {"oscillator-1", "flapping-spring-full-wings", "power-2"}
"""Scenarios of every run of the tests; the others are slow ones."""
FINE = 16
FLOOR = 1e-9
"""Relative error below which there is rounding in both."""
NOTICES = {"coupling energy", "estimated error", "not estimated", "no estimate"}
RANDOM = 20


def judged(name: str, plan: Plan) -> tuple[float, float, bool]:
    """True and estimated error of the leading variables, and whether the run warns."""
    done = run(plan, estimate=True)
    if done.failure is not None:
        return 0.0, 0.0, True
    exact = run(with_step(plan, own(plan), plan.grid.step / FINE), estimate=False).checked()
    true = max(errors(done, exact)[0][n] for n in plan.leading)
    said = largest_error(done)[1]
    warned = bool(meaningless(done)) or bool(noticed(done))
    ratio = said / true if true > 0.0 else float("nan")
    print(f"{name}: true {true:.2e}, estimated {said:.2e}, ratio {ratio:.2f}, warned {warned}")
    return true, said, warned


def noticed(done: Outcome) -> set[str]:
    return {warning.kind for warning in warnings(done)} & NOTICES


def check(true: float, said: float, warned: bool) -> None:
    """An estimate is within a factor of three and a half; what is wrong by 1 % has a warning."""
    assert warned or true <= INACCURATE
    if max(true, said) > FLOOR and true < 0.3:
        assert 1.0 / 3.5 < said / true < 3.5


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in QUICK else [pytest.mark.slow])
        for name in scenario_names()
    ],
)
def test_every_scenario_says_how_wrong_it_is(native: Path, name: str) -> None:
    check(*judged(name, load(name, None, native)))


def drawn(seed: int) -> tuple[str, dict[str, str], dict[str, dict[str, object]]]:
    """A scenario with sizes, step and master at random."""
    choice = random.Random(seed)
    base = choice.choice(["oscillator-1", "oscillator-4", "flapping-spring-full-wings", "power-4"])
    kind = choice.choice(["gauss-seidel", "jacobi", "extrapolated"])
    laws = choice.choice(["held", "affine", "curvature", "curvature"])
    steps = round(10.0 ** choice.uniform(1.3, 2.3))
    frequency = {"oscillator-1": 51.8, "oscillator-4": 60.0, "power-4": 35.0}.get(base, 18.0)
    changes = {
        "amplifier.frequency": f"{frequency * choice.uniform(0.5, 1.5):.3f} Hz",
        "amplifier.amplitude": f"{choice.uniform(800.0, 1900.0):.0f} V",
    }
    time = {"stop": f"{choice.randint(6, 20)} cycles", "step": {"per_cycle": steps}}
    return base, changes, {"time": time, "master": {"kind": kind, "laws": laws}}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(RANDOM))
def test_a_random_scenario_says_how_wrong_it_is(native: Path, seed: int) -> None:
    base, changes, options = drawn(seed)
    true, _, warned = judged(f"{base} {changes} {options}", load(base, changes, native, **options))
    assert warned or true <= INACCURATE


def foreign_systems(folder: Path, shelf: Shelf) -> Iterator[tuple[str, Plan]]:
    """Systems of other people's FMUs, in this process."""
    yield "prey and predators", load(populations(folder, shelf, step=0.01, isolate=False))
    yield (
        "prey and predators, far too long a step",
        load(populations(folder, shelf, step=0.2, isolate=False)),
    )
    for kind in ("jacobi", "gauss-seidel", "extrapolated"):
        yield f"two masses, {kind}", load(masses(folder, shelf, master=kind, isolate=False))
    yield "a ring of two gains", load(ring(folder, shelf("GAIN", 2), (0.5, -0.5), isolate=False))


def test_foreign_systems_say_how_wrong_they_are(shelf: Shelf, tmp_path: Path) -> None:
    for name, plan in foreign_systems(tmp_path, shelf):
        true, said, warned = judged(name, plan)
        check(true, said, warned)
