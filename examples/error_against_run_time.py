"""Weigh error against run time: one scenario by three methods over a ladder of steps.

You learn: a precision study runs a scenario at multiples of its step and measures each run against
a reference whose own error is bounded; here the monolith, the same physics as one ODE. Ports that
carry laws (`curvature`) are more accurate with a coarse step than bare numbers (`held`) with a fine
one.
"""

from pathlib import Path

from orchestrator.studies.precision.study import precision
from orchestrator.studies.precision.table import cheapest_settings, draw, per_cycle


def main() -> None:
    study = precision(
        "oscillator-1",
        methods=["gauss-seidel/curvature", "gauss-seidel/held", "extrapolated/held"],
        factors=(2.0, 1.0, 0.5),
        options={"time": {"stop": "10 cycles"}},
        repeats=1,
    )
    print(f"largest error of {', '.join(study.variables)}, relative, against {study.reference}")
    for done in study.runs:
        print(
            f"{done.method!s:24} {per_cycle(study, done):14} error {study.error(done):.1e}"
            f" order {done.order:4.1f} {done.wall_time:.2f} s"
        )
    print("cheapest settings:", *cheapest_settings(study), sep="\n  ")
    Path("results").mkdir(exist_ok=True)
    draw(study, Path("results/error_against_run_time.png"))


if __name__ == "__main__":
    main()
