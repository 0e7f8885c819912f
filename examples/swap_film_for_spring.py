"""Swap the film of an actuator for a spring, and see what that changes.

You learn: a part is exchanged by naming another one with the same ports; nothing else of the
scenario changes. Here a component is overridden from Python; in a scenario file it is

    extends = "dea-1"
    [components.spring]
    fmu = "spring"
"""

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from resilin import load, run

SCENARIO, ACTUATOR = "dea-1", "spring"
"""A bench oscillator, and its component that is the actuator: a film, the part `membrane`."""

SPRING = {"stiffness": 63.5, "damping": 0.0, "loss_factor": 0.278, "loss_frequency": "52 Hz",
          "blocked_force": 0.127, "capacitance": 1.312e-9}  # fmt: skip
"""The same actuator as a spring: the printed stiffness, and what was fitted to two figures."""


def main() -> None:
    time = {"stop": "20 cycles"}
    film = load(SCENARIO, time=time)
    parts = {ACTUATOR: {"fmu": "spring", "start": SPRING}}
    record = {"variables": ["payload.displacement"]}  # a spring has no limits to be recorded
    spring = load(SCENARIO, time=time, components=parts, record=record)
    figure, axis = pyplot.subplots(layout="constrained")
    for label, plan in (("film", film), ("spring", spring)):
        outcome = run(plan).checked()
        last = outcome.times > outcome.times[-1] - 2.0 / plan.frequency
        moved = 1e3 * outcome.series("payload.displacement")[last]
        each = 1e6 * outcome.wall_time / outcome.steps
        print(f"{label:6}: travel {np.ptp(moved):.2f} mm, {each:.0f} us a step")
        axis.plot(1e3 * outcome.times[last], moved, label=label)
    axis.set(xlabel="time (ms)", ylabel="displacement (mm)")
    axis.legend()
    Path("results").mkdir(exist_ok=True)
    figure.savefig("results/swap_film_for_spring.png")


if __name__ == "__main__":
    main()
