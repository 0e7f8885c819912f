"""Couple FMUs of somebody else: two masses and the spring between them.

You learn: any co-simulation FMU stands where a part stands. These two are exported with pythonfmu
alone, from `parts/`; they exchange bare numbers and run in processes of their own, so that a crash
does not end the master. Where numbers feed back, the master `extrapolated` is of second order in
the step; holding them (`gauss-seidel`) is of first order. The exact motion is known.
"""

import shutil
from pathlib import Path

import numpy as np
from pythonfmu.builder import FmuBuilder

from resilin import load, run

PARTS = Path(__file__).parent / "parts"
SCENARIO = """
title = "Two masses and a spring between them"
[time]
stop = 10
step = 0.02
[components.left]
fmu = "./Mass.fmu"
[components.right]
fmu = "./Mass.fmu"
start = { start_displacement = 0.0 }
[components.spring]
fmu = "./CouplingSpring.fmu"
[record]
variables = ["left.displacement", "right.displacement"]
""" + "".join(
    f'[[wires]]\nfrom = "{mass}.displacement"\nto = "spring.{mass}"\n'
    f'[[wires]]\nfrom = "spring.force_on_{mass}"\nto = "{mass}.force"\n'
    for mass in ("left", "right")
)


def main() -> None:
    folder = Path("results") / "two_foreign_fmus"
    shutil.rmtree(folder, ignore_errors=True)
    for part in ("mass", "coupling_spring"):
        FmuBuilder.build_FMU(PARTS / f"{part}.py", dest=folder)
    (folder / "masses.toml").write_text(SCENARIO)
    for kind in ("gauss-seidel", "extrapolated"):
        for step in (0.04, 0.02):
            plan = load(folder / "masses.toml", time={"step": step}, master={"kind": kind})
            outcome = run(plan, estimate=False).checked()
            t = outcome.times
            exact = 0.5 * (np.cos(t) + np.cos(np.sqrt(3.0) * t))
            error = np.abs(outcome.series("left.displacement") - exact).max()
            each = 1e6 * outcome.wall_time / outcome.steps
            print(f"{kind:12} step {step} s: largest error {error:.1e}, {each:.0f} us a step")


if __name__ == "__main__":
    main()
