"""Linearise a scenario about its state of rest, and go on with python-control.

You learn: `linearise` nudges the held inputs of a scenario, through the FMUs alone, and gives a
sampled state space with named signals. Its poles are those of the oscillator; python-control does
the rest. The force follows the square of the voltage, so about 0 V nothing would come of a nudge: a
bias of 1 kV on both electrodes makes the response linear.
"""

from pathlib import Path

import control
import numpy as np
from matplotlib import pyplot

from orchestrator.simulation.linear.state_space import linearise
from resilin import load


def main() -> None:
    plan = load(
        "oscillator-1",
        {"amplifier.waveform": "external"},
        hold={"amplifier.command.top": "1 kV", "amplifier.command.bottom": "1 kV"},
    )
    found = linearise(plan, inputs=["amplifier.command.top"], outputs=["payload.displacement"])
    for pole in found.eigenvalues():
        if pole.imag > 0.0:
            size = abs(pole)
            print(f"pole: {size / (2 * np.pi):.2f} Hz, damping ratio {-pole.real / size:.4f}")

    system = found.state_space()
    print(f"{system.nstates} states, sampled every {1e3 * system.dt:.3f} ms")
    frequencies = np.linspace(1.0, 100.0, 1000)
    gain = np.abs(control.frequency_response(system, 2 * np.pi * frequencies).frdata[0, 0])
    print(f"at rest {1e6 * gain[0]:.2f} um a volt", end=", ")
    print(f"at {frequencies[gain.argmax()]:.1f} Hz {1e6 * gain.max():.2f} um a volt")
    time, moved = control.step_response(100.0 * system, 0.3)
    info = control.step_info(moved, time)
    overshoot, settled = info["Overshoot"], 1e3 * info["SettlingTime"]
    print(f"a step of 100 V: overshoot {overshoot:.0f} %, settled after {settled:.0f} ms")
    figure, axis = pyplot.subplots(layout="constrained")
    axis.plot(time, 1e3 * moved)
    axis.set(xlabel="time (s)", ylabel="displacement (mm) after a step of 100 V")
    Path("results").mkdir(exist_ok=True)
    figure.savefig("results/linearise_with_control.png")


if __name__ == "__main__":
    main()
