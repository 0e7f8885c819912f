"""Fit parameters of parts to a recording: stiffness and loss of the spring, and the mass.

You learn: a recording drives the parts that are named and is compared with what they put out; the
others of the scenario give way to it. Values come with intervals, and with remarks on what speaks
against them. The recording is made here, from known values and noise of 20 um.
"""

from pathlib import Path

import numpy as np

from orchestrator.report.image import draw
from orchestrator.studies.identification import Asked, case_of, identify, unknowns_of
from orchestrator.studies.identification.table import figure, remarks
from resilin import dataset, load, run

TRUTH = {"spring.stiffness": 70.0, "spring.loss_factor": 0.25, "payload.mass": 0.65e-3}
MEASURED = "payload.motion.displacement"


def write_recording(path: Path) -> None:
    plan = load(
        "oscillator-1",
        {name: str(value) for name, value in TRUTH.items()},
        time={"stop": "5 cycles", "step": {"per_cycle": 40}},
        record={"variables": ["amplifier.*.voltage", MEASURED]},
    )
    data = dataset(run(plan).checked())
    data[MEASURED] += np.random.default_rng(1).normal(0.0, 20e-6, data.sizes["time"])
    data.to_netcdf(path)


def main() -> None:
    Path("results").mkdir(exist_ok=True)
    recording = Path("results/fit_a_parameter.nc")
    write_recording(recording)
    parts = ["spring", "payload"]
    case = case_of(recording, Asked(parts, scenario="oscillator-1", outputs=[MEASURED]))
    found = identify(case, unknowns_of(list(TRUTH), case.plan, parts))
    for unknown, value, width in zip(found.unknowns, found.values, found.intervals, strict=True):
        true = TRUTH[unknown.full]
        print(f"{unknown.full}: {value:.4g} +- {width:.2g} {unknown.unit}, true {true:g}")
    print(f"{found.runs} runs in {found.wall_time:.1f} s", *remarks(found), sep="\n")
    draw(figure(found), [Path("results/fit_a_parameter.png")])


if __name__ == "__main__":
    main()
