"""A scenario checked against the descriptions of its FMUs: names, units, causality, time.

Nothing is loaded here. The result is a :class:`Plan`, or a :class:`ScenarioError` that lists
everything that does not fit.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import FmuError, Problems, RecordingError, nearest, printable
from ..fmi.built import digest_of, is_built_here
from ..fmi.description import Interface, Variable, read_interface
from ..fmi.instance.base import Limits
from ..units import UnitError, si_value
from .actions import Action, actions_of
from .connections import Connection, check_all_fed, connections_of, held_of
from .execution_order import order_of
from .faults import Fault, faults_of
from .files import is_file
from .library import LIBRARY, built_part, located, missing_part
from .metric_definitions import check_metrics
from .patterns import matches
from .schema import AUTO, Scenario
from .start_values import starts_of, without_misfits
from .substitution import substituted
from .time_grid import Grid, frequency_of, grid_of, seconds

if TYPE_CHECKING:
    from ..recording.recording import Recording

HARDLY = 0.01
"""Share of a run in which a recording has to have rows."""
NOT_BUILT_HERE = (
    "names Resilin as its tool, but was not built on this machine: it runs in a process of its own,"
    " as a foreign FMU does; `resilin build` makes parts that run faster"
)


@dataclass(frozen=True)
class Plan:
    """A checked scenario: what to load, how it is wired, when it communicates, what is kept.

    `limits` holds outside the master's process; `keep_from` is the time [s] from which rows are
    kept; `step_reason` is the reason for the step where the scenario left it open. `recordings`
    take the place of parts; `dropped` lists what the scenario loses by that, and by other FMUs in
    the place of those of a base scenario; `changes` are the settings given beside its file.
    `digests` are the SHA-256 of the components' files, taken when they were checked. `texts` are
    the String variables that are recorded beside `records`.
    """

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
    actions: list[Action] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    limits: dict[str, Limits] = field(default_factory=dict)
    keep_from: float = -inf
    step_reason: str = ""
    recordings: dict[str, Recording] = field(default_factory=dict)
    dropped: list[str] = field(default_factory=list)
    changes: dict[str, str] = field(default_factory=dict)
    digests: dict[str, str] = field(default_factory=dict)
    texts: list[tuple[str, Variable]] = field(default_factory=list)

    @property
    def record_names(self) -> list[str]:
        """The recorded variables as `component.variable`, in the order of `records`."""
        return [f"{name}.{variable.name}" for name, variable in self.records]

    @property
    def text_names(self) -> list[str]:
        """The recorded texts as `component.variable`, in the order of `texts`."""
        return [f"{name}.{variable.name}" for name, variable in self.texts]

    @property
    def leading(self) -> list[str]:
        """Recorded variables whose errors count: `record.leading`, else what is wired, else all.

        Only real numbers are among them: what switches is right or wrong, and not by a share.
        """
        names = [f"{name}.{variable.name}" for name, variable in self.records if variable.real]
        patterns = self.scenario.record.leading
        chosen = [n for n in names if any(matches(n, pattern) for pattern in patterns)]
        wired = {f"{c.source}.{c.output.name}" for c in self.connections if not c.output.order}
        return chosen or [name for name in names if name in wired] or names

    @property
    def fixed_step(self) -> list[str]:
        """Components that take steps of one size only."""
        return [name for name, known in self.interfaces.items() if not known.variable_step]

    @property
    def rolls_back(self) -> bool:
        """Whether every instance can go back to a saved state."""
        return all(known.rollback for known in self.interfaces.values())

    def _repr_html_(self) -> str:
        """What a notebook shows: what `resilin inspect` does."""
        from ..report.notebook import rendered
        from .inspection import card

        return rendered(card(self))


def check(scenario: Scenario, path: Path, library: Path = LIBRARY) -> Plan:
    """Check a scenario against its FMUs; `ScenarioError` with every problem."""
    problems = Problems(path)
    if not scenario.components:
        problems.add("components", "a scenario needs at least one")
    recordings = _recordings(scenario, path, problems)
    interfaces = _interfaces(scenario, path, library, recordings, problems)
    problems.check()
    digests = _digests(interfaces)
    whole = scenario
    scenario, dropped = substituted(scenario, interfaces, _replays(interfaces), problems)
    starts = starts_of(scenario, interfaces, problems, dropped)
    whole = without_misfits(whole, starts)
    fed: dict[str, str] = {}
    connections = connections_of(scenario, interfaces, fed, problems)
    held = held_of(scenario, interfaces, fed, problems)
    if not problems.at("hold", "wires"):
        check_all_fed(interfaces, fed, problems)
    order = order_of(scenario, connections, interfaces, problems)
    records = _records(scenario, interfaces, problems)
    frequency = frequency_of(scenario, interfaces, starts, problems) or _recorded(recordings)
    grid = grid_of(scenario, frequency, problems)
    interfaces |= _beside_the_run(scenario, recordings, grid, problems)
    actions = actions_of(scenario, interfaces, held, frequency, problems)
    faults = faults_of(scenario, interfaces, frequency, problems)
    limits = _limits(scenario, problems)
    check_metrics(scenario, interfaces, problems)
    if scenario.master.kind == AUTO:
        chosen = scenario.master.model_copy(update={"kind": usual(connections)})
        whole = whole.model_copy(update={"master": chosen})
    keep_from = _keep_from(scenario, grid, frequency, problems)
    problems.check()
    assert grid is not None, "a grid is missing only beside a problem"
    plan = Plan(
        scenario=whole,
        path=path,
        interfaces=interfaces,
        starts=starts,
        connections=connections,
        held=held,
        order=order,
        records=[(name, variable) for name, variable in records if variable.numeric],
        texts=[(name, variable) for name, variable in records if not variable.numeric],
        grid=grid,
        frequency=frequency,
        actions=actions,
        faults=faults,
        limits=limits,
        keep_from=keep_from,
        recordings=recordings,
        dropped=dropped,
        digests=digests,
    )
    _check_even(plan, problems)
    problems.check()
    return plan


def usual(connections: list[Connection]) -> str:
    """The master for a scenario that names none.

    Where two components feed each other only bare numbers, holding these is of first order and
    feeds energy into the motion: extrapolated. With laws, or without feedback, Gauss-Seidel is of
    second order at least cost. See docs/reference/coupling.md.
    """
    pairs = {(c.source, c.target) for c in connections}
    lawful = {frozenset((c.source, c.target)) for c in connections if c.input.order}
    mutual = {frozenset(pair) for pair in pairs if pair[::-1] in pairs}
    return "extrapolated" if mutual - lawful else "gauss-seidel"


def _limits(scenario: Scenario, problems: Problems) -> dict[str, Limits]:
    """Time of a call, and memory, that each instance may take outside the master's process."""
    limits = {}
    for name, component in scenario.components.items():
        values = {}
        for key, given, unit in (
            ("patience", component.patience, "s"),
            ("memory", component.memory, "byte"),
        ):
            if given is None:
                continue
            try:
                values[key] = si_value(given, unit)
            except UnitError as error:
                problems.add(f"components.{name}.{key}", error)
                continue
            if values[key] <= 0.0:
                problems.add(f"components.{name}.{key}", "must be above zero")
        usual = Limits()
        limits[name] = Limits(
            values.get("patience", usual.patience), int(values.get("memory", usual.memory))
        )
    return limits


def _keep_from(
    scenario: Scenario, grid: Grid | None, frequency: float | None, problems: Problems
) -> float:
    """Time from which rows are kept: all of the run, or a last stretch of it."""
    if scenario.record.last is None or grid is None:
        return -inf
    last = seconds("record.last", scenario.record.last, frequency, problems)
    if last <= 0.0:
        problems.add("record.last", "must be above zero")
    return grid.stop - last - 1e-9 * grid.step


def _check_even(plan: Plan, problems: Problems) -> None:
    """Note where a scenario asks other steps of components that take steps of one size only."""
    fixed = ", ".join(plan.fixed_step)
    grid = plan.grid
    if not fixed:
        return
    if abs(grid.start + grid.count * grid.step - grid.stop) > 1e-9 * grid.step:
        problems.add(
            "time.stop",
            f"{fixed} takes steps of one size only, and {grid.stop - grid.start:g} s is not a"
            f" multiple of {grid.step:g} s",
        )
    if plan.scenario.time.tolerance is not None:
        problems.add(
            "time.tolerance", f"needs steps of any size, which {fixed} cannot take; give a step"
        )


def fmu_path(name: str, scenario: Path, library: Path) -> Path:
    """File of a component: a built part by name, or a path from the scenario's folder."""
    if name.endswith(".fmu") or "/" in name:
        given = Path(name)
        return given if given.is_absolute() else scenario.parent / given
    return built_part(name, located(library, scenario))


def interface_of(name: str, scenario: Path, library: Path) -> Interface:
    """Interface of a part by its name or of an FMU by its path; `FmuError` where there is none.

    Of an FMU that says it is ours but has not been built here, `ours` is false.
    """
    file = fmu_path(name, scenario, library)
    if not (name.endswith(".fmu") or "/" in name) and not is_file(file):
        raise FmuError(missing_part(name, located(library, scenario), scenario))
    known = read_interface(file)
    if known.ours and not is_built_here(digest_of(file)):
        return replace(known, ours=False, warnings=(NOT_BUILT_HERE, *known.warnings))
    return known


def _recordings(scenario: Scenario, path: Path, problems: Problems) -> dict[str, Recording]:
    """Recordings of a scenario, read and checked; their readers are imported only if needed."""
    found: dict[str, Recording] = {}
    for name, component in scenario.components.items():
        if component.data is None:
            continue
        from ..recording.recording import open_recording

        try:
            found[name] = open_recording(component, path)
        except RecordingError as error:
            for line in error.problems:
                problems.add(f"components.{name}.data", line)
    return found


def _beside_the_run(
    scenario: Scenario, recordings: dict[str, Recording], grid: Grid | None, problems: Problems
) -> dict[str, Interface]:
    """Interfaces of recordings that hardly meet the run, with a warning that says so.

    One that gives a single value throughout because its rows lie elsewhere is a problem, unless
    the scenario says what holds there.
    """
    doubtful: dict[str, Interface] = {}
    for name, recording in recordings.items():
        if grid is None or recording.track.period:
            continue
        given = scenario.components[name].model_fields_set
        begin, end = recording.begin, recording.end
        late = begin > grid.stop - HARDLY * (grid.stop - grid.start) and "before" not in given
        early = end < grid.start + HARDLY * (grid.stop - grid.start) and "after" not in given
        times = recording.rows + recording.offset
        met = int(((times >= grid.start) & (times <= grid.stop)).sum())
        text = (
            f"its rows are from {begin:.9g} to {end:.9g} s, and {met or 'none'} of {len(times)} in"
            f' the run from {grid.start:g} to {grid.stop:g} s; offset = "first" lays the first row'
            ' on the time 0, units = { time = "ms" } gives the unit of its times'
        )
        if late or early:
            problems.add(f"components.{name}.data", text)
        elif met < 2:
            interface = recording.interface
            doubtful[name] = replace(interface, warnings=(*interface.warnings, text))
    return doubtful


def _digests(interfaces: dict[str, Interface]) -> dict[str, str]:
    """SHA-256 of the file of each component, each file read once."""
    files = {known.path for known in interfaces.values()}
    digests = {path: digest_of(path) for path in files}
    return {name: digests[known.path] for name, known in interfaces.items()}


def _replays(interfaces: dict[str, Interface]) -> list[str]:
    """Components without inputs: recordings, and FMUs that `build --recording` has made of them."""
    return [n for n, i in interfaces.items() if i.ours and not i.of("input")]


def _recorded(recordings: dict[str, Recording]) -> float | None:
    """Frequency of the recordings' cycle [Hz], where they agree on one."""
    frequencies = {r.frequency for r in recordings.values() if r.frequency}
    return frequencies.pop() if len(frequencies) == 1 else None


def _interfaces(
    scenario: Scenario,
    path: Path,
    library: Path,
    recordings: dict[str, Recording],
    problems: Problems,
) -> dict[str, Interface]:
    """Interface of each component, each file read once."""
    known: dict[Path, Interface] = {}
    interfaces: dict[str, Interface] = {}
    for name, component in scenario.components.items():
        if not name.isidentifier():
            problems.add(f"components.{printable(name)}", "not a name of letters, digits and _")
            continue
        if component.fmu is None:
            if name in recordings:
                interfaces[name] = recordings[name].interface
            continue
        file = fmu_path(component.fmu, path, library)
        if file not in known:
            try:
                known[file] = interface_of(component.fmu, path, library)
            except FmuError as error:
                problems.add(f"components.{name}.fmu", error)
                continue
        interfaces[name] = known[file]
        if not component.rollback:
            interfaces[name] = replace(known[file], rollback=False)
        for warning in interfaces[name].warnings if scenario.strict else ():
            problems.add(f"components.{name}.fmu", f"{file}: modelDescription.xml: {warning}")
    return interfaces


def _records(
    scenario: Scenario, interfaces: dict[str, Interface], problems: Problems
) -> list[tuple[str, Variable]]:
    """Variables that match a pattern of the record list, in the scenario's order."""
    chosen: set[tuple[str, str]] = set()
    for index, pattern in enumerate(scenario.record.variables):
        found = [
            (component, name)
            for component, interface in interfaces.items()
            for name in _matching(component, interface, pattern)
        ]
        if not found:
            outputs = [f"{c}.{v.name}" for c, i in interfaces.items() for v in i.of("output")]
            hint = nearest(pattern, outputs)
            problems.add(f"record.variables[{index}]", f"no output {printable(pattern)!r}; {hint}")
        chosen.update(found)
    return [
        (component, variable)
        for component, interface in interfaces.items()
        for variable in interface.variables.values()
        if (component, variable.name) in chosen
    ]


RECORDABLE = (("output",), ("local",), ("parameter", "calculatedParameter"))
"""What a pattern stands for: outputs; where none matches, local variables; then parameters.

A String is recorded where it is named whole.
"""


def _matching(component: str, interface: Interface, pattern: str) -> list[str]:
    """Variables of one component that a pattern stands for."""
    for causalities in RECORDABLE:
        if found := [
            v.name
            for v in interface.of(*causalities)
            if (v.numeric and matches(f"{component}.{v.name}", pattern))
            or (v.kind == "String" and f"{component}.{v.name}" == pattern)
        ]:
            return found
    return []
