"""The flapping vehicle against figure 11, a monolithic ODE, and its own energy."""

from __future__ import annotations

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

FLAPPING = ("flapping-no-wing", "flapping-frames", "flapping-full-wings")


def value(outcome: Outcome, name: str) -> float:
    return {m.name: m.value for m in metrics(dataset(outcome))}[name]


@pytest.mark.parametrize(
    ("scenario", "frequency", "stroke", "tolerance"),
    [
        ("flapping-no-wing", 34.0, 96.0, 0.01),  # both calibrated
        ("flapping-frames", 22.0, 83.0, 0.01),  # both calibrated
        ("flapping-full-wings", 18.0, 63.0, 0.04),  # frequency calibrated, stroke predicted
    ],
)
def test_peaks_of_figure_11(
    outcome: Runner, scenario: str, frequency: float, stroke: float, tolerance: float
) -> None:
    """The stroke at the peak, and that it is a peak: 3 % to either side it is less."""
    strokes = [
        np.degrees(value(outcome(scenario, {"amplifier.frequency": f"{f} Hz"}), "flapping stroke"))
        for f in (0.97 * frequency, frequency, 1.03 * frequency)
    ]
    assert strokes[1] == pytest.approx(stroke, rel=tolerance)
    assert strokes[1] > max(strokes[0], strokes[2])


def against_monolith(library: Path, scenario: str, laws: str, steps: int, cycles: int) -> float:
    time = {"stop": f"{cycles} cycles"}
    base = load(scenario, None, library, time={**time, "step": {"per_cycle": 10}})
    reference = as_recorded(run(monolithic(base, library)), base)
    assert reference.failure is None
    timed = {**time, "step": {"per_cycle": steps}}
    master = {"laws": laws, "kind": "gauss-seidel"}
    plan = load(scenario, None, library, master=master, time=timed)
    coupled = run(plan)
    assert coupled.failure is None
    worst = 0.0
    for name in reference.names:
        if name.endswith(("displacement", "flap_angle")):
            exact = reference.series(name)
            error = np.abs(coupled.series(name)[:: steps // 10] - exact).max()
            worst = max(worst, float(error / np.abs(exact).max()))
    return worst


@pytest.mark.parametrize("scenario", [*FLAPPING, *(f"oscillator-{k}" for k in range(1, 6))])
def test_a_thousandth_at_fifty_steps_per_cycle(library: Path, scenario: str) -> None:
    assert against_monolith(library, scenario, "curvature", 50, 6) < 1e-3


@pytest.mark.parametrize("scenario", ["bench-silicone", "dea-1"])
def test_a_film_at_full_voltage_takes_eighty(library: Path, scenario: str) -> None:
    """Half of the spacer's height to either side, and a drive with kinks."""
    assert against_monolith(library, scenario, "curvature", 80, 6) < 1e-3


def test_laws_beat_numbers_by_their_order(library: Path) -> None:
    errors = {
        (laws, n): against_monolith(library, "flapping-full-wings", laws, n, 5)
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


@pytest.mark.parametrize("scenario", [*FLAPPING, "oscillator-1"])
def test_energy_closes_over_twenty_cycles(outcome: Runner, scenario: str) -> None:
    """supplied = stored + dissipated + aerodynamic, to 1e-3 of what was supplied."""
    done = outcome(scenario, time={"stop": "20 cycles"})

    def last(name: str) -> float:
        return float(done.series(name)[-1]) if name in done.names else 0.0

    supplied = last("amplifier.supplied_energy")
    spent = sum(
        last(name)
        for name in (
            "amplifier.dissipated_energy",
            "spring.dissipated_energy",
            "spring.elastic_energy",
            "spring.electrical_energy",
            "payload.kinetic_energy",
            "linkage.kinetic_energy",
            "linkage.stop_energy",
            "linkage.viscous_loss",
            "linkage.friction_loss",
            "linkage.stop_loss",
            "linkage.load_work",
        )
    )
    assert supplied == pytest.approx(spent, abs=1e-3 * supplied)
