"""Figure 9: displacement, kinetic and elastic energy of the two-layer stack at resonance."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...report.plot import Axis, Curve, Figure, Plot
from .cached_runs import CachedRuns
from .comparison import Comparison, row
from .job import Answer, plan_of, start_of
from .layer_sweeps import LAYERS, stacks
from .metrics import fourier, power
from .published_values import given, number
from .sensitivity import in_words, sensitivities


def figure9(cached_runs: CachedRuns) -> Comparison:
    """Three cycles at the peak of figure 8's first curve."""
    frequency_sweep = stacks(cached_runs)[0]
    peak = frequency_sweep.peak(power)
    title = "Figure 9: energies at resonance"
    if peak is None:
        return Comparison("figure9", title, (), (), (), frequency_sweep.failures)
    frequency = frequency_sweep.nearest(peak.at)
    kept = ("payload.displacement", "payload.kinetic_energy", "spring.elastic_energy")
    job = replace(frequency_sweep.sweep.job(frequency), keep=kept, per_cycle=120)

    def phase(answer: Answer) -> float:
        return _phase(answer, frequency)

    rows = [
        row("figure9.stroke", cached_runs.measured(job, _stroke), job.scenario),
        row("figure9.phase", cached_runs.measured(job, phase), job.scenario),
    ]
    words: tuple[str, ...] = (
        f"{LAYERS[0]} layers per cone, 1 g, at the frequency of largest power, {frequency:g} Hz."
        " Elastic energy is that of films and relaxation branches, less that at rest.",
        "Both energies go round twice in a cycle of the motion. Ninety degrees of the motion, as"
        " the paper says it, are half a turn of theirs: one is largest where the other is least.",
    )
    (answer,) = cached_runs.answers([job])
    (slopes,) = sensitivities(cached_runs, [job], _stroke)
    ours, theirs = float(rows[0].ours), float(number("figure9.stroke").value) / 100.0
    much = (theirs / ours) ** (1.0 / slopes["permittivity"]) - 1.0
    words += (
        f"What the stroke rests on, for 1 % more of each: {in_words(slopes)}. The paper's 99 %"
        f" would take {100 * much:+.0f} % of permittivity, or as much less loss, against which"
        " table 1 and figure 3 speak: nothing here is fitted to this figure.",
    )
    mass = start_of(plan_of(job, cached_runs.library), "payload.mass")
    speed = math.pi * theirs * float(given("spacer")) * float(number("figure8.resonance").value)
    asked = 0.5 * mass * speed**2 * float(number("figure8.resonance").value)
    words += (
        "The paper contradicts itself here: 99 % of the height at"
        f" {number('figure8.resonance').value} Hz with {1e3 * mass:.3g} g is {1e3 * asked:.1f} mW"
        f" once a cycle, where table 2 has {number('table2.power_2').value} mW. No film can meet"
        " both.",
    )
    return Comparison("figure9", title, words, rows, [_drawn(answer)], frequency_sweep.failures)


def _stroke(answer: Answer) -> float:
    return answer.metrics["travel"] / float(given("spacer"))


def _phase(answer: Answer, frequency: float) -> float:
    """Lag of the elastic behind the kinetic energy, in the motion's cycle [rad]."""
    kinetic = fourier(answer.times, answer.series("kinetic_energy"), 2.0 * frequency)
    elastic = fourier(answer.times, answer.series("elastic_energy"), 2.0 * frequency)
    return 0.5 * (math.atan2((kinetic / elastic).imag, (kinetic / elastic).real) % math.tau)


def _drawn(answer: Answer) -> Figure:
    time = (1e3 * (answer.times - answer.times[0])).tolist()
    place = 1e3 * answer.series("displacement")
    across = Axis("time (ms)")
    energies = [
        Curve(name, time, (1e3 * np.asarray(answer.series(series))).tolist())
        for name, series in (("kinetic", "kinetic_energy"), ("elastic", "elastic_energy"))
    ]
    return Figure(
        "figure9",
        "Two layers at resonance",
        "The last three cycles.",
        [
            Plot("Displacement", across, Axis("displacement (mm)"),
                 [Curve("payload", time, place.tolist())]),
            Plot("Energies", across, Axis("energy (mJ)"), energies),
        ],
    )  # fmt: skip
