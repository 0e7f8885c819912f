"""A scene held against what its FMUs say of themselves: names, units, causality, time.

Nothing is loaded here. The result is a :class:`Plan`, or a :class:`SceneError` that lists all
that does not fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from math import ceil, isclose, isfinite
from pathlib import Path

from .errors import FmuError, SceneError, nearest, printable
from .interface import Interface, Variable, read_interface
from .scenario import PerCycle, Scenario, Wire, is_file
from .units import UnitError, factor, si_value

LAW_ORDERS = {"held": 0, "affine": 1, "curvature": 2}
MOST_STEPS = 1_000_000_000
LIBRARY = Path("build") / "fmus"


@dataclass(frozen=True)
class Connection:
    """One scalar that goes from an output to an input: target = gain * source + offset."""

    source: str
    output: Variable
    target: str
    input: Variable
    gain: float
    offset: float


@dataclass(frozen=True)
class Grid:
    """Communication points start + k step for k = 0 ... count, the last one at `stop`."""

    start: float
    stop: float
    step: float
    count: int

    def point(self, k: int) -> float:
        """Time of communication point `k` [s]."""
        return self.stop if k == self.count else self.start + k * self.step


@dataclass(frozen=True)
class Plan:
    """A checked scene: what to load, how it is wired, when it communicates, what is kept."""

    scenario: Scenario
    path: Path
    interfaces: dict[str, Interface]
    starts: dict[str, dict[str, float | str]]
    connections: list[Connection]
    held: dict[str, float]
    order: list[str]
    records: list[tuple[str, Variable]]
    grid: Grid
    frequency: float | None


def check(scenario: Scenario, path: Path, library: Path = LIBRARY) -> Plan:
    """Resolve a scene against its FMUs; `SceneError` with every problem."""
    problems: list[str] = []
    if not scenario.components:
        raise SceneError(f"{path}: components: a scene needs at least one")
    interfaces = _interfaces(scenario, path, library, problems)
    if problems:
        raise SceneError(f"{path}: {problem}" for problem in problems)
    starts = _starts(scenario, interfaces, problems)
    fed: dict[str, str] = {}
    connections = _connections(scenario, interfaces, fed, problems)
    held = _held(scenario, interfaces, fed, problems)
    if not any(problem.startswith(("hold", "wires")) for problem in problems):
        _check_all_fed(interfaces, fed, problems)
    order = _order(scenario, problems)
    records = _records(scenario, interfaces, problems)
    frequency = _frequency(scenario, interfaces, starts, problems)
    grid = _grid(scenario, frequency, problems)
    if problems or grid is None:
        raise SceneError(f"{path}: {problem}" for problem in dict.fromkeys(problems))
    return Plan(
        scenario, path, interfaces, starts, connections, held, order, records, grid, frequency
    )


def fmu_path(name: str, scene: Path, library: Path) -> Path:
    """File of a component: a built part by name, or a path from the scene's folder."""
    if name.endswith(".fmu") or "/" in name:
        given = Path(name)
        return given if given.is_absolute() else scene.parent / given
    return library / f"{name}.fmu"


def _interfaces(
    scenario: Scenario, path: Path, library: Path, problems: list[str]
) -> dict[str, Interface]:
    """Interface of each component, each file read once."""
    known: dict[Path, Interface] = {}
    interfaces: dict[str, Interface] = {}
    for name, component in scenario.components.items():
        if not name.isidentifier():
            problems.append(f"components.{printable(name)}: not a name of letters, digits and _")
            continue
        file = fmu_path(component.fmu, path, library)
        if file not in known:
            try:
                if file.parent == library and not is_file(file):
                    raise FmuError(_missing_part(component.fmu, library))
                known[file] = read_interface(file)
            except FmuError as error:
                problems.append(f"components.{name}.fmu: {error}")
                continue
        interfaces[name] = known[file]
    return interfaces


def _missing_part(name: str, library: Path) -> str:
    built = [p.stem for p in library.glob("*.fmu")] if library.is_dir() else []
    if not built:
        return f"no part {name!r} in {library}, which holds no FMU; run: resilin build"
    return f"no part {name!r} in {library}; {nearest(name, built)} (resilin build makes parts)"


def _starts(
    scenario: Scenario, interfaces: dict[str, Interface], problems: list[str]
) -> dict[str, dict[str, float | str]]:
    """Start values in the FMUs' units, by component and variable."""
    starts: dict[str, dict[str, float | str]] = {}
    for name, component in scenario.components.items():
        settable = {v.name: v for v in interfaces[name].of("parameter", "input")}
        starts[name] = {}
        for key, value in component.start.items():
            where = f"components.{name}.start.{key}"
            if key not in settable:
                known = interfaces[name].variables
                hint = (
                    f"it is an {known[key].causality}" if key in known else nearest(key, settable)
                )
                problems.append(f"{where}: no parameter {key!r} in {name}; {hint}")
                continue
            try:
                starts[name][key] = _start(settable[key], value)
            except UnitError as error:
                problems.append(f"{where}: {error}")
    return starts


def _start(variable: Variable, value: float | str | bool) -> float | str:
    """One start value as the FMU takes it; `UnitError` where it does not fit."""
    if variable.kind == "String":
        return str(value)
    if variable.kind == "Boolean":
        if not isinstance(value, bool):
            raise UnitError(f"expected true or false, got {value!r}")
        return float(value)
    if variable.choices:
        if value not in variable.choices:
            raise UnitError(f"{value!r} is not a choice; {nearest(str(value), variable.choices)}")
        return float(variable.choices.index(str(value)) + 1)
    number = si_value(value, variable.unit or "1")
    low, high = variable.least, variable.most
    if (low is not None and number < low) or (high is not None and number > high):
        bounds = f"{'-inf' if low is None else low} to {'inf' if high is None else high}"
        raise UnitError(f"{value!r} is outside {bounds} {variable.unit}")
    if variable.kind == "Integer" and not number.is_integer():
        raise UnitError(f"expected a whole number, got {value!r}")
    return number


def _connections(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    fed: dict[str, str],
    problems: list[str],
) -> list[Connection]:
    """Scalar connections of all wires; `fed` notes what feeds each input."""
    most = LAW_ORDERS[scenario.master.laws]
    connections: list[Connection] = []
    for index, wire in enumerate(scenario.wires):
        where = f"wires[{index}] {printable(wire.source)} -> {printable(wire.target)}"
        try:
            pairs = _pairs(wire, interfaces)
            for source, output, target, input_ in pairs:
                scale = factor(output.unit, input_.unit) if output.unit and input_.unit else 1.0
                name = f"{target}.{input_.name}"
                if name in fed:
                    raise SceneError(f"{name} is fed twice, by {fed[name]} too")
                fed[name] = where
                if output.kind != "Real" or input_.kind != "Real":
                    raise SceneError(f"{name} or its source is not Real; only Real can be wired")
                if input_.order > most or output.order > most:
                    continue
                connections.append(
                    Connection(source, output, target, input_, scale * wire.gain, wire.offset)
                )
        except (SceneError, UnitError) as error:
            problems.append(f"{where}: {error}")
            continue
    return connections


def _pairs(
    wire: Wire, interfaces: dict[str, Interface]
) -> list[tuple[str, Variable, str, Variable]]:
    """Outputs and inputs that a wire joins, as (component, output, component, input)."""
    source, outputs, whole = _end(wire.source, interfaces, "output")
    target, inputs, into_port = _end(wire.target, interfaces, "input")
    if not whole or not into_port:
        if len(outputs) > 1 and whole:
            outputs = outputs[:1]
        return [(source, outputs[0], target, inputs[0])]
    by_member = {v.member: v for v in inputs}
    pairs = [(source, o, target, by_member[o.member]) for o in outputs if o.member in by_member]
    if not pairs:
        raise SceneError(
            f"the ports share no member: {', '.join(v.member for v in outputs[:6])} against"
            f" {', '.join(v.member for v in inputs[:6])}"
        )
    if wire.gain != 1.0 or wire.offset != 0.0:
        raise SceneError("gain and offset are for single variables, not for whole ports")
    return pairs


def _end(
    text: str, interfaces: dict[str, Interface], causality: str
) -> tuple[str, list[Variable], bool]:
    """One end of a wire: component, variables, and whether it names a port."""
    component, _, rest = text.partition(".")
    if component not in interfaces:
        raise SceneError(f"no component {printable(component)!r}; {nearest(component, interfaces)}")
    interface = interfaces[component]
    variable = interface.variables.get(rest)
    if variable is not None:
        if variable.causality != causality:
            raise SceneError(_wrong_causality(component, variable, causality))
        return component, [variable], False
    members = interface.port(rest, causality)
    if members:
        return component, members, True
    names = [v.name for v in interface.of(causality)] + interface.ports()
    raise SceneError(f"no {causality} {printable(rest)!r} in {component}; {nearest(rest, names)}")


def _wrong_causality(component: str, variable: Variable, causality: str) -> str:
    name = f"{component}.{variable.name}"
    if variable.causality == "parameter":
        return f"{name} is a parameter: set it under components.{component}.start"
    return f"{name} is an {variable.causality}, expected an {causality}"


def _held(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    fed: dict[str, str],
    problems: list[str],
) -> dict[str, float]:
    """Held inputs and their values; wires of the same input are told apart from them."""
    held: dict[str, float] = {}
    for name, value in scenario.hold.items():
        where = f"hold.{printable(name)}"
        try:
            _, variables, whole = _end(name, interfaces, "input")
            if whole:
                raise SceneError(f"is a port; hold its first member, {variables[0].name}")
            if name in fed:
                raise SceneError(f"is wired too, by {fed[name]}; remove one of the two")
            held[name] = si_value(value, variables[0].unit or "1")
        except (SceneError, UnitError) as error:
            problems.append(f"{where}: {error}")
            continue
        fed[name] = where
    return held


def _check_all_fed(
    interfaces: dict[str, Interface], fed: dict[str, str], problems: list[str]
) -> None:
    """Every input is wired or held; silence would be an assumption.

    A port whose first member is fed counts as fed: its other members keep their start
    values, which is a plain number in the place of a law.
    """
    for component, interface in interfaces.items():
        lacking: dict[str, Variable] = {}
        for variable in interface.of("input"):
            first = interface.port(variable.port, "input")[0] if variable.port else variable
            if not fed.keys() & {f"{component}.{variable.name}", f"{component}.{first.name}"}:
                lacking.setdefault(first.name, first)
        for variable in lacking.values():
            name = f"{component}.{variable.name}"
            remedy = f'wire it, or hold: "{name}" = "0 {variable.unit}"'
            problems.append(f"{name}: neither wired nor held; {remedy}")


def _order(scenario: Scenario, problems: list[str]) -> list[str]:
    """Order in which a sequential master steps: as given, else as the scene lists components."""
    listed = list(scenario.components)
    order = scenario.master.order or listed
    for name in order:
        if name not in listed:
            problems.append(f"master.order: no component {name!r}; {nearest(name, listed)}")
    unknown = set(order) - set(listed)
    if len(set(order)) != len(order):
        problems.append("master.order: a component stands twice")
    elif not unknown and (missing := [name for name in listed if name not in order]):
        problems.append(f"master.order: {', '.join(missing)} is missing")
    return list(order)


def _records(
    scenario: Scenario, interfaces: dict[str, Interface], problems: list[str]
) -> list[tuple[str, Variable]]:
    """Outputs that match a pattern of the record list, in the scene's order."""
    patterns = scenario.record.variables
    outputs = [
        (name, v)
        for name, interface in interfaces.items()
        for v in interface.of("output")
        if v.kind == "Real"
    ]
    names = [f"{name}.{v.name}" for name, v in outputs]
    for index, pattern in enumerate(patterns):
        if not any(fnmatchcase(name, pattern) for name in names):
            hint = nearest(pattern, names)
            problems.append(f"record.variables[{index}]: no output {printable(pattern)!r}; {hint}")
    return [
        entry
        for entry, name in zip(outputs, names, strict=True)
        if any(fnmatchcase(name, pattern) for pattern in patterns)
    ]


def _frequency(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    starts: dict[str, dict[str, float | str]],
    problems: list[str],
) -> float | None:
    """Frequency of a cycle: `time.frequency`, else the one parameter of that name."""
    if scenario.time.frequency is not None:
        try:
            value = si_value(scenario.time.frequency, "Hz")
        except UnitError as error:
            problems.append(f"time.frequency: {error}")
            return None
        if value <= 0.0:
            problems.append("time.frequency: must be above zero")
            return None
        return value
    found = [
        starts[name].get("frequency", interface.variables["frequency"].start)
        for name, interface in interfaces.items()
        if "frequency" in starts[name] or _has_parameter(interface, "frequency")
    ]
    if len(found) == 1 and isinstance(found[0], float) and found[0] > 0.0:
        return found[0]
    return None


def _has_parameter(interface: Interface, name: str) -> bool:
    variable = interface.variables.get(name)
    return variable is not None and variable.causality == "parameter"


def _grid(scenario: Scenario, frequency: float | None, problems: list[str]) -> Grid | None:
    """Communication points; the last step is shortened where `stop` is no multiple."""
    time = scenario.time
    before = len(problems)
    if any(problem.startswith("time.frequency") for problem in problems):
        return None
    start = _seconds("time.start", time.start, frequency, problems)
    stop = _seconds("time.stop", time.stop, frequency, problems)
    if isinstance(time.step, PerCycle):
        if frequency is None:
            problems.append("time.step: per_cycle needs a frequency; give time.frequency")
        step = 1.0 / frequency / time.step.per_cycle if frequency else 1.0
    else:
        step = _seconds("time.step", time.step, frequency, problems)
    if len(problems) > before:
        return None
    span = stop - start
    if not (isfinite(span) and isfinite(step)):
        problems.append("time.stop: start, stop and step have to be finite; see the frequency")
    elif step <= 0.0:
        problems.append(f"time.step: must be above zero, got {step:g} s")
    elif span <= 0.0:
        problems.append(f"time.stop: {stop:g} s is not after time.start, {start:g} s")
    elif step > span * (1.0 + 1e-12):
        problems.append(f"time.step: {step:g} s is longer than the run of {span:g} s")
    elif not span / MOST_STEPS <= step:
        problems.append(f"time.step: with {step:g} s the steps are more than {MOST_STEPS:.0e}")
    if len(problems) > before:
        return None
    whole = round(span / step)
    count = whole if isclose(whole * step, span, rel_tol=1e-9) else ceil(span / step)
    return Grid(start, stop, step, max(1, count))


def _seconds(where: str, value: float | str, frequency: float | None, problems: list[str]) -> float:
    """A time in seconds or cycles; a problem noted and 0 returned where it is neither."""
    try:
        if isinstance(value, str):
            number, _, unit = value.strip().partition(" ")
            if unit.strip() in {"cycle", "cycles"}:
                if frequency is None:
                    problems.append(f"{where}: cycles need a frequency; give time.frequency")
                    return 0.0
                return si_value(number, "1") / frequency
        return si_value(value, "s")
    except UnitError as error:
        problems.append(f"{where}: {error}")
        return 0.0
