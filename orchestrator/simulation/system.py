"""Loaded instances, wired: one buffer of inputs, one of outputs, and the moves between them.

Each instance reads into and writes from its own stretch of two shared arrays, so that passing a
port is one slice assignment, recording a row one gather, and checking all values one call.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, chdir
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from ..errors import InitialisationError, InstanceFailure, SimulationError
from ..fmi.description import EVENT, Interface, Variable
from ..fmi.instance import Instance, open_instance
from ..scenario.actions import Action
from ..scenario.execution_order import deciders, reachable
from ..scenario.plan import Plan
from ..scenario.processes import needs_own
from .coupled_instance import CoupledInstance, Indices, Values
from .initialisation import InconsistentValues, make_consistent
from .unpacked import unpacked

Opened = Callable[[str, Interface, Path], Instance]


@dataclass(frozen=True)
class Moment:
    """Everything that a rollback needs: FMU states, values, and held inputs."""

    states: list[Any]
    values: Values
    buffers: list[Values]


class System:
    """Instances of a plan, loaded, connected and initialised; a context manager.

    `values` holds all outputs that are wired, recorded or announce events, named by `names`;
    `wired` are the places of those that are wired. `instances` are in the execution order of the
    plan; `followers` are those whose outputs follow their inputs directly, in dependency order:
    after a step they are brought up to the new communication point. `residual` is the relative
    residual of the initial values. `opened` makes an instance of a name, its interface and the
    folder that its FMU was unpacked in; by default it is made in the process where it belongs.
    """

    def __init__(self, plan: Plan, opened: Opened | None = None) -> None:
        self.plan = plan
        self._open = opened
        self.instances: list[CoupledInstance] = []
        self.followers: list[CoupledInstance] = []
        self.names: list[str] = []
        self.values: Values = np.zeros(0)
        self.variables: list[Variable] = []
        self.wired: Indices = np.zeros(0, dtype=np.intp)
        self.residual = 0.0
        self.loop = False
        self._stack = ExitStack()
        self.events: list[int] = []

    def __enter__(self) -> Self:
        try:
            self._load()
        except InstanceFailure as error:
            self.close()
            raise InitialisationError(f"{self.plan.path}: {error}") from None
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free all instances, then remove the folders they were unpacked in."""
        self._stack.close()

    def next_event(self) -> float:
        """Time of the next discontinuity that an instance announces; infinity without one."""
        return min((float(self.values[i]) for i in self.events), default=np.inf)

    @property
    def announces(self) -> bool:
        """Whether any instance announces discontinuities."""
        return bool(self.events)

    def follow(self) -> None:
        """Bring outputs that follow inputs directly up to the present communication point."""
        for coupled in self.followers:
            coupled.follow()
        if self.loop:
            try:
                make_consistent(self.followers, self.values, self.wired)
            except InconsistentValues as error:
                raise SimulationError(
                    f"{self.names[error.place]} is in an algebraic loop that does not settle:"
                    f" still changing by {error.change:.2g}"
                ) from None

    def save(self) -> Moment:
        """The whole state at this communication point, for `restore` and `forget`."""
        states = [coupled.instance.save() for coupled in self.instances]
        return Moment(states, self.values.copy(), [m.buffer.copy() for m in self.instances])

    def restore(self, moment: Moment) -> None:
        """Back to a saved communication point, which stays saved."""
        self.values[:] = moment.values
        for coupled, state, buffer in zip(
            self.instances, moment.states, moment.buffers, strict=True
        ):
            coupled.instance.restore(state)
            coupled.buffer[:] = buffer

    def forget(self, moment: Moment) -> None:
        """Free a saved communication point."""
        for coupled, state in zip(self.instances, moment.states, strict=True):
            coupled.instance.forget(state)

    def act(self, action: Action) -> None:
        """Set the values of a timed action, then update all outputs that follow from them."""
        coupled = next(m for m in self.instances if m.instance.name == action.component)
        parameters = {}
        for name, value in action.values.items():
            if name in coupled.held:
                coupled.buffer[coupled.held[name]] = value
            else:
                parameters[name] = value
        if parameters:
            coupled.instance.set(parameters)
        coupled.follow()
        self.follow()

    def _load(self) -> None:
        plan = self.plan
        folders: dict[Path, Path] = {}
        instances: dict[str, Instance] = {}
        for name in plan.order:
            instance = self._opened(name, folders)
            self._stack.callback(instance.close)
            if faults := [fault for fault in plan.faults if fault.component == name]:
                from .fault_injection import FaultyInstance

                instance = FaultyInstance(instance, faults)
            instances[name] = instance
        self._connect(instances)
        self._initialise()

    def _opened(self, name: str, folders: dict[Path, Path]) -> Instance:
        """Instance of a component; `folders` holds those of the FMUs unpacked so far."""
        plan = self.plan
        if name in plan.recordings:
            from ..recording.instance import RecordingInstance

            return RecordingInstance(name, plan.recordings[name])
        interface = plan.interfaces[name]
        if interface.path not in folders:
            kept = unpacked(interface.path, plan.digests[name], keep=interface.ours)
            folders[interface.path] = self._stack.enter_context(kept)
        folder = folders[interface.path]
        if self._open is not None:
            return self._open(name, interface, folder)
        isolate = needs_own(plan, name) or plan.scenario.components[name].isolate
        return open_instance(name, interface, folder, isolate, plan.limits[name], home(plan))

    def _connect(self, instances: dict[str, Instance]) -> None:
        """Lay out both buffers and bind every instance to its stretch of them."""
        plan = self.plan
        groups = {name: self._groups(name) for name in plan.order}
        place: dict[tuple[str, str], int] = {}
        for name in plan.order:
            for variable in (v for group in groups[name] for v in group):
                place[name, variable.name] = len(self.variables)
                self.variables.append(variable)
                self.names.append(f"{name}.{variable.name}")
                if variable.name == EVENT and variable.unit == "s":
                    self.events.append(len(self.variables) - 1)
        self.values = np.zeros(len(self.variables))
        sources = sorted({place[c.source, c.output.name] for c in plan.connections})
        self.wired = np.array(sources, dtype=np.intp)
        first = 0
        deciding = deciders(plan.connections, plan.interfaces)
        for name in plan.order:
            count = sum(len(group) for group in groups[name])
            stretch = slice(first, first + count)
            arriving = [c for c in plan.connections if c.target == name]
            arriving.sort(key=lambda c: place[c.source, c.output.name])
            held = {
                key.partition(".")[2]: value
                for key, value in plan.held.items()
                if key.startswith(f"{name}.")
            }
            from_places = [place[c.source, c.output.name] for c in arriving]
            coupled = CoupledInstance(
                instance=instances[name],
                values=self.values,
                stretch=stretch,
                arriving=arriving,
                sources=np.array(from_places, dtype=np.intp),
                held=held,
                decides=name in deciding,
            )
            inputs = [c.input for c in arriving]
            inputs += [plan.interfaces[name].variables[key] for key in held]
            instances[name].connect(inputs, coupled.buffer, groups[name], self.values[stretch])
            self.instances.append(coupled)
            first += count
        self._find_followers()

    def _groups(self, name: str) -> list[list[Variable]]:
        """Variables of an instance that are read: those that later instances need, then others."""
        plan = self.plan
        later = set(plan.order[plan.order.index(name) :])
        leaving = [c for c in plan.connections if c.source == name]
        used = {c.output.name for c in leaving}
        recorded = {v.name: v for component, v in plan.records if component == name}
        used |= set(recorded)
        outputs = plan.interfaces[name].of("output")
        outputs += [v for v in recorded.values() if v.causality != "output"]
        used |= {v.name for v in outputs if v.name == EVENT and v.real}
        soon = {c.output.name for c in leaving if c.target in later}
        return [
            [v for v in outputs if v.name in soon],
            [v for v in outputs if v.name in used and v.name not in soon],
        ]

    def _find_followers(self) -> None:
        """Find instances with a used output that follows a wired input directly, sources first."""
        plan = self.plan
        wired = {(c.target, c.input.name): c for c in plan.connections}
        direct: dict[str, set[str]] = {}
        for name, variable in zip(
            (n.partition(".")[0] for n in self.names), self.variables, strict=True
        ):
            inputs = variable.depends
            if variable.causality != "output":
                inputs = ()  # recorded as it is: what is looked at never changes a run
            elif inputs is None:
                inputs = tuple(v.name for v in plan.interfaces[name].of("input"))
            for key in inputs:
                if (name, key) in wired:
                    direct.setdefault(name, set()).add(wired[name, key].source)
        names = list(direct)
        reach = reachable(names, [(s, n) for n, found in direct.items() for s in found & {*names}])
        self.loop = any(name in reach[name] for name in names)
        done: list[str] = []
        waiting = [name for name in plan.order if name in direct]
        while waiting:
            ready = [n for n in waiting if not (direct[n] - {n}) & set(waiting)] or waiting[:1]
            done += ready
            waiting = [n for n in waiting if n not in ready]
        by_name = {coupled.instance.name: coupled for coupled in self.instances}
        self.followers = [by_name[name] for name in done]
        for coupled in self.instances:
            coupled.direct = coupled in self.followers
            if not coupled.direct:
                coupled.instance.read_whole_at_once()

    def _initialise(self) -> None:
        """Initialisation mode of all instances, with values passed until nothing changes."""
        grid = self.plan.grid
        tolerance = self.plan.scenario.time.tolerance
        with chdir(home(self.plan)):
            for coupled in self.instances:
                name = coupled.instance.name
                stop = grid.stop if self.plan.scenario.components[name].stop_time else None
                coupled.instance.prepare(self.plan.starts[name], grid.start, stop, tolerance)
            for coupled in self.instances:
                coupled.instance.enter_initialisation()
            for coupled in self.instances:
                coupled.instance.receive()
            try:
                self.residual = make_consistent(self.instances, self.values, self.wired)
            except InconsistentValues as error:
                raise InitialisationError(self._inconsistent(error)) from None
            for coupled in self.instances:
                coupled.instance.exit_initialisation()
        for coupled in self.instances:
            coupled.follow()

    def _has_values(self, coupled: CoupledInstance) -> bool:
        """Whether an instance's outputs are finite."""
        return bool(np.isfinite(self.values[coupled.stretch]).all())

    def _inconsistent(self, error: InconsistentValues) -> str:
        """Why start values do not fit: the last message of an instance, else the worst value.

        One that had no values of its own accord comes before those that its values upset.
        """
        logged = [
            f"{m.instance.name}: {text}"
            for m in sorted(self.instances, key=self._has_values)
            for text in m.instance.messages[-1:]
        ]
        if logged:
            return f"{self.plan.path}: {logged[0]}"
        name, value = self.names[error.place], self.values[error.place]
        return (
            f"{self.plan.path}: {name} = {value:g} does not settle at the start (still changing"
            f" by {error.change:.2g}); give other start values"
        )


def home(plan: Plan) -> Path:
    """The scenario's folder, from where FMUs find files that their parameters name."""
    folder = plan.path.resolve().parent
    return folder if folder.is_dir() else Path.cwd()
