"""Close a loop: a controller FMU finds the resonance of the oscillator, whatever its mass.

You learn: a controller is an FMU of its own, here `parts/resonance_finder.py`. A scenario that
extends another one adds the component and its wires; a wire takes the place of an inherited hold,
and a start value switches the amplifier to its external command.
"""

import shutil
from math import pi, sqrt
from pathlib import Path

from matplotlib import pyplot
from pythonfmu.builder import FmuBuilder

from orchestrator.results.metrics import metrics
from resilin import dataset, load, run

PARTS = Path(__file__).parent / "parts"
SCENARIO = """
title = "An oscillator that finds its resonance"
extends = "oscillator-1"
time = { stop = "25 cycles", frequency = "52 Hz", step = { per_cycle = 100 } }
[components.amplifier]
start = { waveform = "external" }
[components.controller]
fmu = "./ResonanceFinder.fmu"
start = { amplitude = 1000 }
""" + "".join(
    f'[[wires]]\nfrom = "{source}"\nto = "{target}"\n'
    for source, target in (
        ("payload.velocity", "controller.velocity"),
        ("controller.top", "amplifier.command.top"),
        ("controller.bottom", "amplifier.command.bottom"),
    )
)


def main() -> None:
    folder = Path("results") / "controller_in_the_loop"
    shutil.rmtree(folder, ignore_errors=True)
    FmuBuilder.build_FMU(PARTS / "resonance_finder.py", dest=folder)
    (folder / "loop.toml").write_text(SCENARIO)
    figure, axis = pyplot.subplots(layout="constrained")
    for mass in (0.4e-3, 0.6e-3, 0.8e-3):
        outcome = run(load(folder / "loop.toml", {"payload.mass": str(mass)})).checked()
        found = {m.name: m.value for m in metrics(dataset(outcome))}
        natural = sqrt(63.5 / mass) / (2.0 * pi)
        print(
            f"{1e3 * mass:.1f} g: {found['frequency']:.1f} Hz, natural {natural:.1f} Hz;"
            f" travel {1e3 * found['travel']:.2f} mm"
        )
        travel = 1e3 * outcome.series("payload.displacement")
        axis.plot(outcome.times, travel, label=f"{1e3 * mass:.1f} g", lw=0.8)
    axis.set(xlabel="time (s)", ylabel="displacement (mm)")
    axis.legend()
    figure.savefig("results/controller_in_the_loop.png")


if __name__ == "__main__":
    main()
