"""Equation 6: lift of the prototype, frequencies for hovering, and the coefficients implied."""

from __future__ import annotations

import math

import numpy as np

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns, Measured
from .comparison import Comparison, Row
from .job import Job
from .metrics import lift
from .published_values import given, number

GRAVITY = 9.80665


def mass(coefficient: float, stroke: float, frequency: float, length: float, ratio: float) -> float:
    """Mass that hovers, m = 0.387 Phi^2 n^2 R^4 C_L / AR, SI with the stroke in rad."""
    k = float(given("equation6"))
    return k * stroke**2 * frequency**2 * length**4 * coefficient / ratio


def equation6(cached_runs: CachedRuns) -> Comparison:
    """The equation with the paper's own numbers, and the lift that a run finds."""
    stroke = math.radians(float(number("figure11.full_wings_stroke").value))
    frequency = float(number("figure11.full_wings_frequency").value)
    wing = (stroke, frequency, float(given("wing_length")), float(given("aspect_ratio")))
    low, high = given("lift_coefficients")
    rows = [
        Row("equation6.lift", mass(c, *wing), f"equation with C_L = {c:g}") for c in (low, high)
    ]
    found, job = _simulated(cached_runs)
    rows.append(
        Row(
            key="equation6.lift",
            ours=found.value / GRAVITY,
            reading="mean lift of the run, quasi-steady",
            doubt=found.doubt / GRAVITY,
            scenario=job.scenario,
            wall_time=found.wall_time,
        )
    )
    implied = 1e-6 * float(number("equation6.lift").value) / mass(1.0, *wing)
    rows.append(_coefficient("equation6.coefficient", implied))
    rows += _hovering()
    words = (
        "The equation gives a mass for a lift coefficient, which the paper bounds (2 to 3) and does"
        " not state. Its three statements imply three different ones; the two on hovering exclude"
        " each other, since the frequency goes as one over the wing's length squared.",
        "The run's lift is that of assumed quasi-steady coefficients with elastic feathering; it"
        " leaves out wake and rotation, and cannot reach coefficients above 1.7.",
    )
    failures = [f"{job.scenario}: {found.reason}"] if found.reason else []
    return Comparison(
        "equation6", "Equation 6: lift and hovering", words, rows, [_drawn()], failures
    )


def _simulated(cached_runs: CachedRuns) -> tuple[Measured, Job]:
    frequency = float(number("figure11.full_wings_frequency").value)
    changes = {"amplifier.frequency": f"{frequency!r} Hz"}
    job = Job("flapping-full-wings", changes, length=60, per_cycle=100, cycles=5)
    return cached_runs.measured(job, lift), job


def _coefficient(key: str, implied: float) -> Row:
    low, high = given("lift_coefficients")
    return Row(key, f"{implied:.3g}", agrees=low <= implied <= high)


def _hovering() -> list[Row]:
    """Frequencies that 10 g ask for, and the coefficients that the stated ones imply."""
    rows = []
    for name, length in zip(("short", "long"), given("hover_lengths"), strict=True):
        stated = float(number(f"equation6.{name}").value)
        for coefficient in given("lift_coefficients"):
            needed = _frequency(coefficient, length)
            rows.append(Row(f"equation6.{name}", needed, f"C_L = {coefficient:g}"))
        implied = (_frequency(1.0, length) / stated) ** 2
        rows.append(_coefficient(f"equation6.{name}_coefficient", implied))
    return rows


def _frequency(coefficient: float, length: float) -> float:
    """Flapping frequency at which the paper's 10 g hover."""
    stroke, ratio = math.radians(given("hover_stroke")), float(given("hover_aspect_ratio"))
    return math.sqrt(float(given("hover_mass")) / mass(coefficient, stroke, 1.0, length, ratio))


def _drawn() -> Figure:
    lengths = np.linspace(35e-3, 90e-3, 56)
    curves = [
        Curve(f"C_L = {c:g}", (1e3 * lengths).tolist(), [_frequency(c, r) for r in lengths])
        for c in given("lift_coefficients")
    ]
    stated = [float(number(f"equation6.{name}").value) for name in ("short", "long")]
    paper = Curve("paper", [1e3 * r for r in given("hover_lengths")], stated, "stated")
    plot = Plot(
        title="Hovering with 10 g",
        x=Axis("wing length (mm)"),
        y=Axis("frequency (Hz)", least=0.0),
        curves=[*curves, paper],
    )
    caption = "Stroke 120 degrees, aspect ratio 7. Both of the paper's points lie off one curve."
    return Figure("equation6", "Frequency to hover", caption, [plot])
