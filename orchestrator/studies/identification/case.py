"""The scenario in which a recording drives parts, and the outputs that are compared with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from ...errors import InputError, ScenarioError, nearest, printable
from ...fmi.description import Interface, Variable
from ...recording.columns import EVERY
from ...recording.named_column import on_command_line
from ...recording.recording import Recording, open_recording
from ...scenario.component_options import component_of
from ...scenario.library import LIBRARY
from ...scenario.parse import load_scenario
from ...scenario.plan import Plan, interface_of
from ...scenario.schema import Component, MasterSettings, Metrics, Record, Scenario, Time, Wire
from ...simulation.load import planned

RECORDED = "recording"
FEWEST = 3


@dataclass(frozen=True)
class Case:
    """A checked plan of parts and the recording that drives them.

    `pairs` are names of recorded outputs and of the parts' own; `points` are the times [s] at
    which both are compared and instances communicate.
    """

    plan: Plan
    pairs: Sequence[tuple[str, str]]
    points: Sequence[float]

    @property
    def units(self) -> list[str]:
        """Unit of measure of each pair."""
        known = {f"{name}.{v.name}": v.unit for name, v in self.plan.records}
        return [known[own] for _, own in self.pairs]


@dataclass(frozen=True)
class Asked:
    """A user's request to fit parts to a recording; see :func:`case_of`."""

    parts: Sequence[str]
    scenario: str | None = None
    keys: Mapping[str, str] | None = None
    hold: Mapping[str, float | str] | None = None
    outputs: Sequence[str] = ()
    changes: Mapping[str, str] | None = None
    step: float | None = None


def case_of(path: Path, asked: Asked, library: Path = LIBRARY) -> Case:
    """A recording that drives parts, and is compared with what they put out.

    Without a scenario there is one part, a built one or a path to an FMU, and columns have the
    names of its variables. With a scenario the parts are components of it and step in its order,
    the recording replaces all others, and columns are called `component.variable`. `keys` are those
    of a recorded
    component, `hold` gives inputs that were not recorded, `changes` start values; `outputs` are
    patterns of the recorded outputs that count, by default all but the slopes and curvatures of
    laws. Communication points are the rows of the recording, or every `step` [s].

    Raises :class:`InputError` where parts, columns or inputs do not fit together.
    """
    keys = dict(asked.keys or {})
    if asked.scenario is not None:
        keys.setdefault("component", EVERY)
    component = component_of(path, RECORDED, keys)
    recording = open_recording(component, path)
    points = _points(recording, asked.step)
    if asked.scenario is None:
        scenario, place = _alone(asked, component, recording, library)
    else:
        scenario, place = _within(asked, component, recording)
    pairs = _pairs(path, asked, scenario, place, recording, library)
    time = {
        "start": points[0], "stop": points[-1],
        "step": (points[-1] - points[0]) / (len(points) - 1), "tolerance": None,
    }  # fmt: skip
    update = {
        "time": scenario.time.model_copy(update=time),
        "record": Record(variables=[name for pair in pairs for name in pair]),
    }
    return Case(planned(scenario.model_copy(update=update), place, library), pairs, points)


def _points(recording: Recording, step: float | None) -> list[float]:
    """Times of the rows, or of steps from the first of them to the last."""
    rows = recording.rows + recording.offset
    if step is not None:
        count = int((rows[-1] - rows[0]) / step * (1.0 + 1e-9))
        rows = rows[0] + step * np.arange(count + 1)
    if len(rows) < FEWEST:
        raise InputError(
            f"{recording.interface.path}: {len(rows)} points in time are too few to fit to"
        )
    return [float(t) for t in rows]


def _alone(
    asked: Asked, component: Component, recording: Recording, library: Path
) -> tuple[Scenario, Path]:
    """One part with its recorded inputs wired and the others held at the FMU's start values."""
    if len(asked.parts) != 1:
        raise InputError("--part: several parts need --scenario, which says how they are wired")
    name, place = _name(asked.parts[0]), Path("fit.toml").absolute()
    known = interface_of(asked.parts[0], place, library)
    columns = set(recording.interface.variables)
    held = dict(asked.hold or {})
    wires = []
    hold = {f"{name}.{key.removeprefix(f'{name}.')}": value for key, value in held.items()}
    for port in dict.fromkeys(v.port or v.name for v in known.of("input")):
        first = (known.port(port, "input") or [known.variables[port]])[0]
        if first.name in columns:
            wires.append(Wire(source=f"{RECORDED}.{port}", target=f"{name}.{port}"))
        else:
            hold.setdefault(f"{name}.{first.name}", float(first.start or 0.0))
    if known.of("input") and not wires:
        inputs = [v.name for v in known.of("input")]
        raise InputError(
            f"{recording.interface.path}: has no column of an input of {name};"
            f" {nearest(min(columns), inputs)}; say which column it is, as"
            f" {on_command_line(columns, inputs[0])}"
        )
    return Scenario(
        components={
            RECORDED: component,
            name: Component(fmu=asked.parts[0], start=dict(asked.changes or {})),
        },
        wires=wires, hold=hold, time=Time(frequency=recording.frequency), master=MasterSettings(),
    ), place  # fmt: skip


def _within(asked: Asked, component: Component, recording: Recording) -> tuple[Scenario, Path]:
    """Parts of a scenario; the recording feeds them in place of all other components."""
    scenario, place = load_scenario(str(asked.scenario), dict(asked.changes or {}))
    for part in asked.parts:
        if part not in scenario.components:
            raise InputError(
                f"--part {printable(part)}: not a component of {asked.scenario};"
                f" {nearest(part, scenario.components)}"
            )
    kept = {name: part for name, part in scenario.components.items() if name in asked.parts}
    order = [name for name in scenario.master.order if name in kept]
    if order:
        order.insert(0, RECORDED)
    hold = {k: v for k, v in scenario.hold.items() if k.partition(".")[0] in kept}
    hold |= asked.hold or {}
    columns = recording.interface.variables
    ports = {v.port for v in columns.values() if v.port}
    wires, problems = [], []
    for wire in scenario.wires:
        source, target = (end.partition(".")[0] for end in (wire.source, wire.target))
        if target not in kept or any(
            key == wire.target or key.startswith(f"{wire.target}.") for key in asked.hold or {}
        ):
            continue
        recorded = [end for end in (wire.source, wire.target) if end in columns or end in ports]
        if source in kept:
            wires.append(wire)
        elif recorded:
            wires.append(wire.model_copy(update={"source": f"{RECORDED}.{recorded[0]}"}))
        else:
            problems.append(
                f"{recording.interface.path}: has no column of {wire.source}, which feeds"
                f" {wire.target} in {asked.scenario}; {nearest(wire.source, {*columns, *ports})};"
                f" say which column it is, as"
                f" {on_command_line(columns, wire.source)}, record it,"
                f" or --hold {wire.target}...=value"
            )
    if problems:
        raise ScenarioError(problems)
    return scenario.model_copy(
        update={
            "components": {RECORDED: component, **kept}, "wires": wires, "hold": hold,
            "actions": [], "faults": [], "without": [], "metrics": Metrics(), "plot": {},
            "master": scenario.master.model_copy(update={"order": order}),
            "time": Time(frequency=recording.frequency or scenario.time.frequency),
        }
    ), place  # fmt: skip


def _pairs(
    path: Path, asked: Asked, scenario: Scenario, place: Path, recording: Recording, library: Path
) -> list[tuple[str, str]]:
    """Recorded columns that the parts put out too, only those that are asked for."""
    prefix = "" if asked.scenario is not None else f"{_name(asked.parts[0])}."
    interfaces = {
        name: interface_of(component.fmu, place, library)
        for name, component in scenario.components.items()
        if component.fmu is not None
    }
    found = {
        name: known.order
        for name in _measured(recording)
        if (known := _output(interfaces, prefix + name)) is not None
    }
    for pattern in asked.outputs:
        if found and not any(_named(name, prefix, pattern) for name in found):
            raise InputError(
                f"--variable {printable(pattern)}: no such recorded output;"
                f" {nearest(pattern, found)}"
            )
    wanted = [
        name
        for name, order in found.items()
        if any(_named(name, prefix, o) for o in asked.outputs) or not (asked.outputs or order)
    ]
    if wanted:
        return [(f"{RECORDED}.{name}", prefix + name) for name in wanted]
    outputs = [f"{n}.{v.name}".removeprefix(prefix) for n, i in interfaces.items()
               for v in i.of("output")]  # fmt: skip
    raise InputError(
        f"{path}: has no column of an output of {', '.join(interfaces)} to compare with;"
        f" {nearest(next(iter(_measured(recording)), ''), outputs)}; say which column it is, as"
        f" {on_command_line(_measured(recording), next(iter(outputs), 'OUTPUT'))}"
    )


def _measured(recording: Recording) -> Iterator[str]:
    """Outputs of a recording that are columns of the file, not derived from them."""
    for name, (how, _, _) in zip(recording.interface.variables, recording.sources, strict=True):
        if how == "column":
            yield name


def _output(interfaces: Mapping[str, Interface], name: str) -> Variable | None:
    """The output with which a column is compared; None where there is none."""
    owner, _, variable = name.partition(".")
    known = interfaces.get(owner)
    found = known.variables.get(variable) if known is not None else None
    is_output = found is not None and found.causality == "output" and found.numeric
    return found if is_output else None


def _named(name: str, prefix: str, pattern: str) -> bool:
    return fnmatchcase(name, pattern) or fnmatchcase(prefix + name, pattern)


def _name(part: str) -> str:
    """The component name of a part without a scenario."""
    name = Path(part).stem
    return name if name.isidentifier() and name != RECORDED else "part"
