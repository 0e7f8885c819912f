"""Each part replaced by its own recording: how far the other parts are then from the whole run.

`python benchmarks/recordings.py` prints the tables of docs/reference/recordings.md: the largest
difference of a variable of the other parts, relative to its largest value.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from orchestrator.results.outcome import Outcome
from orchestrator.results.port_recording import with_recorded_ports, write_port_recording
from orchestrator.scenario.library import LIBRARY
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

KINDS = ("held", "linear", "cubic", "band-limited")
STOP = "10 cycles"
CHARGE = '[hold]\n"amplifier.top.charge" = 0\n"amplifier.bottom.charge" = 0\n'
CASES: dict[str, dict[str, tuple[list[str], str, str]]] = {
    "oscillator-1": {
        "amplifier": (["top.voltage", "bottom.voltage"], "payload.displacement", ""),
        "spring": (["force.value"], "payload.displacement", CHARGE),
        "payload": (["motion.displacement"], "spring.force.value", ""),
    },
    "flapping-full-wings": {
        "amplifier": (["top.voltage", "bottom.voltage"], "linkage.displacement", ""),
        "actuator": (["force.value"], "linkage.displacement", CHARGE),
        "aero": (["load.torque", "load.added_inertia"], "linkage.displacement", ""),
        "linkage": (["motion.displacement", "motion.flap_angle"], "actuator.force.value", ""),
    },
}
"""Part -> columns that are the bare values of its ports, compared variable, and held inputs."""
STEPS = {"oscillator-1": 60, "flapping-full-wings": 50}


def replayed(
    folder: Path, scenario: str, part: str, recording: Path, kind: str, columns: list[str],
    holds: str, library: Path = LIBRARY, **options: object,
) -> Outcome:  # fmt: skip
    """Outcome of a scenario with a recording in one part's place; all columns if none is given."""
    path = folder / "replayed.toml"
    listed = ", ".join(f'"{name}" = "{name}"' for name in columns)
    path.write_text(
        f'extends = "{scenario}"\n[components.{part}]\ndata = "{recording}"\n'
        f'interpolation = "{kind}"\nafter = "hold"\n'
        + (f"columns = {{ {listed} }}\n" if columns else "")
        + (holds if columns else "")
    )
    done = run(load(path, None, library, **options), estimate=False)
    assert done.failure is None, done.failure
    return done


def difference(whole: Outcome, other: Outcome, name: str) -> float:
    """Largest difference of a variable at shared points, relative to its largest value."""
    _, mine, its = np.intersect1d(whole.times.round(12), other.times.round(12), return_indices=True)
    one, two = whole.series(name)[mine], other.series(name)[its]
    return float(np.abs(one - two).max() / np.abs(one).max())


def main() -> None:
    """Print the tables."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for scenario, parts in CASES.items():
            whole = run(load(scenario, time={"stop": STOP}), estimate=False)
            print(f"\n{scenario}, {STOP}\n\n| part | way | {' | '.join(KINDS)} |")
            print("|---|---|" + "---|" * len(KINDS))
            for part, (columns, name, holds) in parts.items():
                for way, finer, used, per_cycle in (
                    ("whole ports", 1, [], STEPS[scenario]),
                    ("whole ports, half the step", 1, [], 2 * STEPS[scenario]),
                    ("values", 1, columns, STEPS[scenario]),
                    ("values, four times as many rows", 4, columns, STEPS[scenario]),
                ):
                    rate = {"per_cycle": finer * STEPS[scenario]}
                    recording = folder / f"{part}-{finer}.csv"
                    if not recording.exists():
                        plan = load(scenario, time={"stop": STOP, "step": rate})
                        recorded = run(with_recorded_ports(plan, part), estimate=False)
                        write_port_recording(recorded, recording)
                    step = {"per_cycle": per_cycle}
                    against = whole
                    if per_cycle != STEPS[scenario]:
                        against = run(
                            load(scenario, time={"stop": STOP, "step": step}), estimate=False
                        )
                    errors = [
                        difference(
                            against,
                            replayed(
                                folder, scenario, part, recording, kind, used, holds,
                                time={"stop": STOP, "step": step},
                            ),
                            name,
                        )
                        for kind in KINDS
                    ]  # fmt: skip
                    print(f"| {part} | {way} | {' | '.join(f'{e:.1e}' for e in errors)} |")
            for recording in folder.glob("*.csv"):
                recording.unlink()


if __name__ == "__main__":
    main()
