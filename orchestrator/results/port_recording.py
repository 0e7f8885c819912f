"""The outputs of a part in a run, as a recording that can take the part's place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf
from pathlib import Path

from ..errors import InputError, nearest, printable
from ..fmi.description import EVENT, Variable
from ..report.files import written_whole
from ..scenario.plan import Plan
from .netcdf import partial_path, provenance, write
from .outcome import Outcome, whole

OMITTED = {"scenario", "fmu_guids"}
"""Provenance too long for a comment line."""


def with_recorded_ports(plan: Plan, part: str) -> Plan:
    """The same scenario, with the outputs of one component recorded at every point of its grid.

    These are all members of its ports, what is wired beside them, and announced events; of a
    component without ports and wires, all outputs. `InputError` where there is no such component.
    """
    if part not in plan.interfaces:
        known = nearest(part, plan.interfaces)
        raise InputError(f"--part {printable(part)}: no such component; {known}")
    kept = _outputs(plan, part)
    if not kept:
        raise InputError(f"--part {part}: has no output that is a number")
    record = plan.scenario.record.model_copy(update={"every": 1, "last": None})
    scenario = plan.scenario.model_copy(update={"record": record})
    return replace(
        plan, scenario=scenario, records=[(part, v) for v in kept], texts=[], keep_from=-inf
    )


def _outputs(plan: Plan, part: str) -> list[Variable]:
    outputs = [v for v in plan.interfaces[part].of("output") if v.numeric]
    wired = {c.output.name for c in plan.connections if c.source == part}
    crossing = [v for v in outputs if v.port or v.name in wired]
    return [v for v in outputs if v in crossing or v.name == EVENT] if crossing else outputs


def left_out(plan: Plan, part: str) -> list[str]:
    """Outputs of a component that no recording holds, as they are no numbers: texts, binaries."""
    outputs = plan.interfaces[part].of("output")
    return [f"{part}.{variable.name}" for variable in outputs if not variable.numeric]


def write_port_recording(outcome: Outcome, path: Path) -> Path:
    """Write the outcome of such a run as .nc or .csv; as `.partial` where it stopped early."""
    if path.suffix == ".nc":
        return write(outcome, path)
    target = path
    if outcome.failure is not None:
        target = path.with_name(partial_path(Path(path.stem)).with_suffix(path.suffix).name)
    with (
        written_whole(target) as waiting,
        waiting.open("w", encoding="utf-8", newline="\n") as file,
    ):
        file.writelines(f"{line}\n" for line in _lines(outcome))
    return target


def _lines(outcome: Outcome) -> Iterator[str]:
    """Provenance as comments, headings with units, rows whose numbers read back as they are."""
    plan = outcome.plan
    noted = {k: v for k, v in provenance(plan).items() if k not in OMITTED}
    noted |= {"component": plan.records[0][0], "complete": int(outcome.failure is None)}
    for key, value in noted.items():
        yield f"# {key}: {printable(str(value), most=2000)}"
    units = [(v.name, v.unit) for _, v in plan.records]
    yield ",".join(["time [s]", *(_heading(name, unit) for name, unit in units)])
    times, rows = whole(outcome)
    for time, row in zip(times.tolist(), rows.tolist(), strict=True):
        yield ",".join(map(repr, [time, *row]))


def _heading(name: str, unit: str) -> str:
    text = f"{name} [{unit}]" if unit else name
    return f'"{text}"' if "," in text else text
