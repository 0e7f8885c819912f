"""Let a measured voltage drive the membrane, in the place of the amplifier.

You learn: a component may be a recording instead of an FMU; columns are renamed and converted
where the file has its own names and units. The file is made here: half sines of 1920 V at 52 Hz
as an oscilloscope may have kept them, in kV, at 5 kHz, with noise.
"""

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from resilin import load, run

FREQUENCY, CYCLES = 52.0, 15


def write_recording(path: Path) -> None:
    time = np.arange(0.0, (CYCLES + 1) / FREQUENCY, 2e-4)
    wave = 1.92 * np.sin(2.0 * np.pi * FREQUENCY * time)
    volts = np.maximum(0.0, np.column_stack([wave, -wave]))
    volts += np.random.default_rng(1).normal(0.0, 0.01, volts.shape)
    rows = np.column_stack([time, volts])
    np.savetxt(path, rows, "%.5f", ",", header="time [s],U1 [kV],U2 [kV]", comments="")


def main() -> None:
    folder = Path("results")
    folder.mkdir(exist_ok=True)
    write_recording(folder / "bench.csv")
    columns = {"U1": "top.voltage", "U2": "bottom.voltage"}
    recording = {"data": str((folder / "bench.csv").absolute()), "columns": columns}
    time = {"stop": f"{CYCLES} cycles", "frequency": FREQUENCY}

    measured = run(load("dea-1", components={"amplifier": recording}, time=time)).checked()
    ideal = run(load("dea-1", {"amplifier.resistance": "0 Ohm"}, time=time)).checked()
    figure, axis = pyplot.subplots(layout="constrained")
    for label, outcome in (("measured", measured), ("ideal", ideal)):
        travel = 1e3 * outcome.series("payload.displacement")
        last = outcome.times > outcome.times[-1] - 3.0 / FREQUENCY
        print(f"{label} voltage: travel {np.ptp(travel[last]):.3f} mm")
        axis.plot(outcome.times, travel, label=label)
    axis.set(xlabel="time (s)", ylabel="displacement (mm)")
    axis.legend()
    figure.savefig(folder / "measured_voltage.png")


if __name__ == "__main__":
    main()
