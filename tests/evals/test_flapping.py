"""The flapping vehicle against figure 11, a monolithic ODE, and its own energy."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.reference.monolith import as_recorded, monolithic
from tests.conftest import Runner

CASES = ("no-wing", "frames", "full-wings")
FILM, LONG, SPRING = "flapping", "flapping-long-rocker", "flapping-spring"
FLAPPING = tuple(f"{reading}-{case}" for reading in (FILM, LONG, SPRING) for case in CASES)

STROKES = {
    "flapping-no-wing": (95.66, 96.00, 95.98),
    "flapping-frames": (82.85, 82.97, 82.98),
    "flapping-full-wings": (63.29, 63.31, 63.34),
    "flapping-long-rocker-no-wing": (95.71, 96.00, 95.99),
    "flapping-long-rocker-frames": (82.85, 82.97, 82.99),
    "flapping-long-rocker-full-wings": (62.71, 62.72, 62.75),
}
"""Strokes [deg] at the peaks by 50, 100 and 400 steps a cycle, of an independent study."""

OVER_FREQUENCY = {
    "flapping-no-wing": {1: 63, 5: 57, 10: 61, 30: 88, 40: 58, 50: 24},
    "flapping-frames": {1: 63, 5: 58, 10: 63, 26: 62, 30: 39},
    "flapping-full-wings": {1: 63, 5: 55, 10: 56, 22: 46, 26: 28},
    "flapping-long-rocker-no-wing": {1: 43, 5: 47, 10: 53, 30: 80},
    "flapping-long-rocker-frames": {26: 59, 30: 36},
}
"""Strokes [deg] beside the peaks [Hz], of the same study, to whole degrees."""


def value(outcome: Outcome, name: str) -> float:
    return {m.name: m.value for m in metrics(dataset(outcome))}[name]


def stroke(library: Path, scenario: str, steps: int, cycles: int = 60, **changes: str) -> float:
    """Settled stroke [deg]; changes as `component__parameter`."""
    time = {"stop": f"{cycles} cycles", "step": {"per_cycle": steps}}
    told = {name.replace("__", "."): text for name, text in changes.items()}
    done = run(load(scenario, told, library, time=time), estimate=False)
    assert done.failure is None
    return float(np.degrees(value(done, "flapping stroke")))


@pytest.mark.parametrize("scenario", STROKES)
def test_strokes_at_the_peaks(native: Path, scenario: str) -> None:
    for steps, expected in zip((50, 100, 400), STROKES[scenario], strict=True):
        assert stroke(native, scenario, steps) == pytest.approx(expected, abs=0.05), steps


@pytest.mark.slow
@pytest.mark.parametrize("scenario", OVER_FREQUENCY)
def test_strokes_beside_the_peaks(native: Path, scenario: str) -> None:
    for frequency, expected in OVER_FREQUENCY[scenario].items():
        steps, cycles = max(100, round(1500 / frequency)), max(8, min(60, 3 * frequency))
        found = stroke(native, scenario, steps, cycles, amplifier__frequency=f"{frequency} Hz")
        assert found == pytest.approx(expected, abs=1.0), frequency


@pytest.mark.parametrize(("case", "expected"), [*zip(CASES, (96.0, 103.1, 78.1), strict=True)])
def test_without_friction_on_the_load(native: Path, case: str, expected: float) -> None:
    found = stroke(native, f"flapping-{case}", 100, linkage__joint_friction="0")
    assert found == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(("case", "expected"), [*zip(CASES, (118.8, 120.6, 118.9), strict=True)])
def test_without_dry_friction_it_meets_its_stops(native: Path, case: str, expected: float) -> None:
    found = stroke(native, f"flapping-{case}", 100, linkage__coulomb_friction="0 N")
    assert found == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(
    ("reading", "predicted"), [(FILM, 0.01), (LONG, 0.01), (SPRING, 0.04)], ids=str
)
@pytest.mark.parametrize(
    ("case", "frequency", "height"),
    [("no-wing", 34.0, 96.0), ("frames", 22.0, 83.0), ("full-wings", 18.0, 63.0)],
)
def test_peaks_of_figure_11(
    native: Path, reading: str, predicted: float, case: str, frequency: float, height: float
) -> None:
    """The stroke at the peak, and that it is a peak: 3 % to either side it is less.

    All are calibrated but the stroke with full wings.
    """
    strokes = [
        stroke(native, f"{reading}-{case}", 50, amplifier__frequency=f"{f} Hz")
        for f in (0.97 * frequency, frequency, 1.03 * frequency)
    ]
    assert strokes[1] == pytest.approx(height, rel=predicted if case == "full-wings" else 0.01)
    assert strokes[1] > max(strokes[0], strokes[2])


@cache
def reference(library: Path, scenario: str, cycles: int) -> Outcome:
    """The monolith at ten points of a cycle."""
    time = {"stop": f"{cycles} cycles", "step": {"per_cycle": 10}}
    base = load(scenario, None, library, time=time)
    done = as_recorded(run(monolithic(base, library)), base)
    assert done.failure is None
    return done


def against_monolith(library: Path, scenario: str, laws: str, steps: int, cycles: int) -> float:
    exact = reference(library, scenario, cycles)
    time = {"stop": f"{cycles} cycles", "step": {"per_cycle": steps}}
    master = {"laws": laws, "kind": "gauss-seidel"}
    coupled = run(load(scenario, None, library, master=master, time=time), estimate=False)
    assert coupled.failure is None
    worst = 0.0
    for name in exact.names:
        if name.endswith(("displacement", "flap_angle")):
            wanted = exact.series(name)
            error = np.abs(coupled.series(name)[:: steps // 10] - wanted).max()
            worst = max(worst, float(error / np.abs(wanted).max()))
    return worst


@pytest.mark.parametrize(
    "scenario", [*(f"{SPRING}-{c}" for c in CASES), *(f"oscillator-{k}" for k in range(1, 6))]
)
def test_a_thousandth_at_fifty_steps_per_cycle(library: Path, scenario: str) -> None:
    assert against_monolith(library, scenario, "curvature", 50, 6) < 1e-3


@pytest.mark.parametrize(
    "scenario", ["bench-silicone", pytest.param("dea-1", marks=pytest.mark.slow)]
)
def test_a_film_at_full_voltage_takes_eighty(library: Path, scenario: str) -> None:
    """Half of the spacer's height to either side, and a drive with kinks."""
    assert against_monolith(library, scenario, "curvature", 80, 6) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scenario", "steps"),
    [*((f"{FILM}-{c}", 100) for c in CASES), *((f"{LONG}-{c}", 200) for c in CASES)],
)
def test_a_film_under_square_waves_takes_a_hundred_or_two(
    library: Path, scenario: str, steps: int
) -> None:
    """Charge over an edge is extrapolated along a curve; stroke is stiff against force."""
    assert against_monolith(library, scenario, "curvature", steps, 6) < 1e-3


@pytest.mark.slow
def test_the_sign_of_dry_friction_is_resolved(library: Path) -> None:
    """Between 100 and 400 steps the error falls by more than the second order."""
    coarse, fine = (
        against_monolith(library, "flapping-full-wings", "curvature", n, 6) for n in (100, 400)
    )
    assert fine < 1e-4
    assert np.log2(coarse / fine) > 2.0 * 2.0


def test_laws_beat_numbers_by_their_order(library: Path) -> None:
    errors = {
        (laws, n): against_monolith(library, "flapping-spring-full-wings", laws, n, 5)
        for laws in ("held", "affine", "curvature")
        for n in (100, 200)
    }
    assert errors["held", 200] > 30 * errors["curvature", 200]
    assert errors["affine", 200] > 10 * errors["curvature", 200]
    for laws, low, high in (("held", 0.7, 1.6), ("affine", 1.3, 3.5), ("curvature", 1.3, 4.5)):
        order = np.log2(errors[laws, 100] / errors[laws, 200])
        assert low < order < high, laws


def test_a_start_from_rest_is_not_a_growth(outcome: Runner) -> None:
    """Power rises as t^6 behind an edge; so fine a step makes that look like an exponential."""
    settings = {"kind": "jacobi", "laws": "held"}
    time = {"stop": "0.25 cycles", "step": {"per_cycle": 1600}}
    assert outcome("flapping-full-wings", time=time, master=settings).failure is None


RECEIVED = "amplifier.supplied_energy"
SPENT = (
    "amplifier.dissipated_energy",
    "spring.dissipated_energy",
    "spring.elastic_energy",
    "spring.electrical_energy",
    "actuator.dissipated_energy",
    "actuator.elastic_energy",
    "actuator.electrical_energy",
    "payload.kinetic_energy",
    "linkage.kinetic_energy",
    "linkage.stop_energy",
    "linkage.viscous_loss",
    "linkage.friction_loss",
    "linkage.stop_loss",
    "linkage.load_work",
)


def unaccounted(done: Outcome) -> float:
    """Supplied less stored, dissipated and delivered over the last ten of twenty cycles [J]."""
    half = (len(done.times) - 1) // 2

    def over(name: str) -> float:
        series = done.series(name) if name in done.names else np.zeros(len(done.times))
        return float(series[-1] - series[half])

    return over(RECEIVED) - sum(map(over, SPENT))


@pytest.mark.parametrize("scenario", [*FLAPPING, "oscillator-1"])
def test_energy_closes_over_twenty_cycles(native: Path, scenario: str) -> None:
    """supplied = stored + dissipated + aerodynamic, to 2e-4 of what was supplied."""
    done = run(load(scenario, None, native, time={"stop": "20 cycles"}), estimate=False)
    assert abs(unaccounted(done)) < 2e-4 * float(done.series(RECEIVED)[-1])


@pytest.mark.parametrize("resistance", ["0 Ohm", "1 kOhm", "0.1 MOhm", "0.3 MOhm", "1 MOhm"])
@pytest.mark.parametrize("waveform", ["square", "raised_sine", "half_wave_sine", "triangle"])
@pytest.mark.parametrize("reading", [FILM, LONG, SPRING])
def test_energy_closes_against_the_mechanical_work(
    native: Path, reading: str, waveform: str, resistance: str
) -> None:
    """To 1e-3 of the work at 50 steps a cycle, though an edge alone supplies ten times as much."""
    changes = {"amplifier.waveform": waveform, "amplifier.resistance": resistance}
    plan = load(
        f"{reading}-full-wings", changes, native,
        time={"stop": "20 cycles", "step": {"per_cycle": 50}},
    )  # fmt: skip
    done = run(plan, estimate=False)
    assert done.failure is None
    work = done.series("linkage.force_work")
    assert abs(unaccounted(done)) < 1e-3 * float(work[-1] - work[len(work) // 2])
