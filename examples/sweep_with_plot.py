"""Sweep the drive's frequency over the resonance of the bench oscillator, for two masses.

You learn: a sweep runs a scenario at every point of a grid, on all processors; a point that fails
costs that point alone, and a sweep that was stopped goes on where it was. Its dataset has
one row for each point.
"""

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from orchestrator.studies.sweep.study import sweep

MASS, FREQUENCY = "payload.mass", "amplifier.frequency"


def main() -> None:
    data = sweep(
        "oscillator-1",
        [f"{FREQUENCY}=42:60:3Hz", f"{MASS}=0.5g,0.7g"],
        target=Path("results/sweep_with_plot.nc"),
        options={"time": {"stop": "10 cycles", "step": {"per_cycle": 30}}},
        workers=2,
    )
    figure, axis = pyplot.subplots(layout="constrained")
    for mass in np.unique(data[MASS]):
        line = data.isel(point=np.flatnonzero(data[MASS] == mass)).sortby(FREQUENCY)
        best = line.isel(point=int(np.argmax(line["travel"].values)))
        print(
            f"{1e3 * mass:.1f} g: {1e3 * float(best['travel']):.2f} mm"
            f" at {float(best[FREQUENCY]):.0f} Hz"
        )
        label = f"{1e3 * mass:.1f} g"
        axis.plot(line[FREQUENCY], 1e3 * line["travel"], "o-", label=label)
    axis.set(xlabel="frequency (Hz)", ylabel="travel (mm)")
    axis.legend()
    figure.savefig("results/sweep_with_plot.png")


if __name__ == "__main__":
    main()  # workers are processes of their own: they import this file again
