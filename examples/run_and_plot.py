"""Run the vehicle, read figures off the result, and plot two variables.

You learn: `load` checks a scenario, `run` steps it, `series` and `dataset` give its values, named
`component.variable`, in SI. With `estimate=True` the scenario runs once more at half the
step, which says how wrong each variable is.
"""

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from resilin import dataset, load, run


def main() -> None:
    plan = load("flapping-full-wings", {"amplifier.frequency": "18 Hz"}, time={"stop": "20 cycles"})
    outcome = run(plan, estimate=True).checked()

    angle = outcome.series("linkage.flap_angle")
    last = outcome.times > outcome.times[-1] - 1.0 / 18.0
    error = outcome.estimates["linkage.flap_angle"].error
    print(f"stroke: {np.degrees(np.ptp(angle[last])):.2f} deg, +- {np.degrees(error):.2g} deg")
    print(f"mean lift: {1e6 * outcome.series('aero.lift')[last].mean() / 9.80665:.0f} mg")
    print(f"{outcome.steps} communication steps in {outcome.wall_time:.2f} s")

    data = dataset(outcome)  # an xarray.Dataset; data.to_netcdf(...) keeps it
    figure, axes = pyplot.subplots(2, sharex=True, layout="constrained")
    for axis, name in zip(axes, ("linkage.flap_angle", "amplifier.top.voltage"), strict=True):
        data[name].sel(time=slice(0.9, None)).plot(ax=axis)
    Path("results").mkdir(exist_ok=True)
    figure.savefig("results/run_and_plot.png")


if __name__ == "__main__":
    main()
