"""Sweep the drive's frequency over the resonance of the bench oscillator, for two masses.

You learn: a sweep runs a scenario at every point of a grid, on all processors; a point that fails
costs that point alone, and a sweep that was stopped goes on where it was. The axes of the grid are
the dimensions of its dataset. `resilin plot` draws such a file as it is.
"""

from pathlib import Path

from matplotlib import pyplot

from resilin import sweep

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
    for mass, travel in data["travel"].groupby(MASS):
        line = 1e3 * travel.squeeze()
        label = f"{1e3 * mass:.1f} g"
        print(f"{label}: {float(line.max()):.2f} mm at {float(line.idxmax()):.0f} Hz")
        axis.plot(line[FREQUENCY], line, "o-", label=label)
    axis.set(xlabel="frequency (Hz)", ylabel="travel (mm)")
    axis.legend()
    figure.savefig("results/sweep_with_plot.png")


if __name__ == "__main__":
    main()  # workers are processes of their own: they import this file again
