"""Frequency sweep of a scenario: amplitude and phase, one run for each point.

    python benchmarks/sweep.py bench-silicone --set amplifier.waveform=half_wave_sine

Prints amplitude (half of peak to peak, over the last cycles) and phase behind the drive, the
peaks, and the frequency at which the phase crosses 90 degrees.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset
from orchestrator.scenario.library import LIBRARY
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

STEPS_PER_SECOND = 1500
"""Least rate of communication: the mass moves at its own frequency however slow the drive."""

PAPER = [1.0, *range(5, 45, 5), *range(44, 66, 2), *range(70, 105, 5)]


def main(
    scenario: Annotated[str, typer.Argument()] = "bench-silicone",
    set_: Annotated[list[str] | None, typer.Option("--set")] = None,
    settle: Annotated[float, typer.Option(help="Seconds before the last cycles.")] = 0.3,
    frequencies: Annotated[str, typer.Option(help="Comma-separated; the paper's if empty.")] = "",
    library: Annotated[Path, typer.Option()] = LIBRARY,
) -> None:
    """Print the sweep."""
    changes = dict(text.split("=", 1) for text in set_ or [])
    wanted = [float(f) for f in frequencies.split(",") if f] or PAPER
    rows = []
    for frequency in wanted:
        cycles = max(4, math.ceil(settle * frequency) + 3)
        plan = load(
            scenario,
            {**changes, "amplifier.frequency": f"{frequency} Hz"},
            library,
            time={
                "stop": f"{cycles} cycles",
                "step": {"per_cycle": max(60, math.ceil(STEPS_PER_SECOND / frequency))},
            },
        )
        outcome = run(plan, estimate=False)
        if outcome.failure is not None:
            rows.append((frequency, math.nan, math.nan))
            Console().print(f"{frequency:g} Hz: {outcome.failure}")
            continue
        found = {m.name: m.value for m in metrics(dataset(outcome), 3)}
        rows.append((frequency, 0.5e3 * found["travel"], math.degrees(found["phase"])))
    table = Table("Hz", "amplitude mm", "phase deg", title=f"{scenario} {changes or ''}")
    for frequency, amplitude, phase in rows:
        table.add_row(f"{frequency:g}", f"{amplitude:.3f}", f"{phase:.1f}")
    Console(width=90).print(table)
    size = np.array([row[1] for row in rows])
    for k in range(1, len(rows) - 1):
        if size[k] > size[k - 1] and size[k] > size[k + 1]:
            Console().print(f"peak {size[k]:.2f} mm at {rows[k][0]:g} Hz")
    for (f0, _, p0), (f1, _, p1) in itertools.pairwise(rows):
        if p0 < 90.0 <= p1:
            Console().print(f"90 degrees at {f0 + (90.0 - p0) / (p1 - p0) * (f1 - f0):.1f} Hz")


if __name__ == "__main__":
    typer.run(main)
