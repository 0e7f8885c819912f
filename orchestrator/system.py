"""Loaded units, wired: one buffer of inputs, one of outputs, and the moves between them.

Each unit reads into and writes from its own stretch of two shared arrays, so that passing a
port is one slice assignment, recording a row one gather, and checking all values one call.
"""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from .archive import extract
from .errors import FmuError, InitialisationError, UnitFailure
from .interface import Variable
from .unit import Unit
from .wiring import Connection, Plan

Values = NDArray[np.float64]
SETTLED = 1e-12
MOST_PASSES = 50
EVENT = "next_event_time"


class Member:
    """A unit in its place: how its inputs are gathered, and what it tells."""

    def __init__(self, unit: Unit, inputs: Values, moves: list[tuple[Values, Values]]) -> None:
        self.unit = unit
        self.inputs = inputs
        self.moves = moves
        self.gain: Values | None = None
        self.offset: Values | None = None

    def gather(self) -> None:
        """Bring the inputs up to date with what the others put out, and pass them on."""
        for target, source in self.moves:
            target[:] = source
        if self.gain is not None and self.offset is not None:
            np.multiply(self.inputs, self.gain, out=self.inputs)
            np.add(self.inputs, self.offset, out=self.inputs)
        self.unit.send()

    def advance(self, time: float, size: float) -> None:
        """Gather, step, and read what units later in the order need."""
        self.gather()
        self.unit.step(time, size)
        self.unit.receive(0)

    def follow(self) -> None:
        """Gather and read all outputs, without a step: outputs that follow inputs directly."""
        self.gather()
        self.unit.receive()


class System:
    """Units of a plan, loaded, connected and initialised; a context manager.

    `values` holds all outputs that are wired, recorded or announce events, named by `names`.
    `members` stand in the order of the plan; `followers` are those whose outputs follow
    their inputs directly, in dependency order: after a step they are brought up to the new
    communication point.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.members: list[Member] = []
        self.followers: list[Member] = []
        self.names: list[str] = []
        self.values: Values = np.zeros(0)
        self.variables: list[Variable] = []
        self._stack = ExitStack()
        self._events: list[int] = []

    def __enter__(self) -> Self:
        try:
            self._load()
        except UnitFailure as error:
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
        """Time of the next discontinuity that a unit announces; infinity without one."""
        return min((float(self.values[i]) for i in self._events), default=np.inf)

    def _load(self) -> None:
        plan = self.plan
        folders: dict[Path, Path] = {}
        units: dict[str, Unit] = {}
        for name in plan.order:
            interface = plan.interfaces[name]
            if interface.path not in folders:
                folders[interface.path] = self._unpacked(interface.path)
            unit = Unit(name, interface, folders[interface.path])
            self._stack.callback(unit.close)
            units[name] = unit
        self._connect(units)
        self._initialise()

    def _unpacked(self, path: Path) -> Path:
        try:
            made = tempfile.TemporaryDirectory(prefix="resilin_", ignore_cleanup_errors=True)
        except OSError as error:
            raise FmuError(
                f"{path}: no folder for temporary files in {tempfile.tempdir}"
                f" ({error.strerror}); set TMPDIR to one that is there and writable"
            ) from None
        folder = Path(self._stack.enter_context(made))
        if "%" in str(folder):
            raise FmuError(f"{path}: FMUs do not load from {folder}; set TMPDIR to one without %")
        extract(path, folder)
        return folder

    def _connect(self, units: dict[str, Unit]) -> None:
        """Lay out both buffers and bind every unit to its stretch of them."""
        plan = self.plan
        groups = {name: self._groups(name) for name in plan.order}
        place: dict[tuple[str, str], int] = {}
        for name in plan.order:
            for variable in (v for group in groups[name] for v in group):
                place[name, variable.name] = len(self.variables)
                self.variables.append(variable)
                self.names.append(f"{name}.{variable.name}")
                if variable.name == EVENT and variable.unit == "s":
                    self._events.append(len(self.variables) - 1)
        self.values = np.zeros(len(self.variables))
        first = 0
        for name in plan.order:
            count = sum(len(group) for group in groups[name])
            arriving = [c for c in plan.connections if c.target == name]
            arriving.sort(key=lambda c: place[c.source, c.output.name])
            held = [key for key in plan.held if key.startswith(f"{name}.")]
            inputs = [c.input for c in arriving]
            inputs += [plan.interfaces[name].variables[key.partition(".")[2]] for key in held]
            buffer = np.zeros(len(inputs))
            buffer[len(arriving) :] = [plan.held[key] for key in held]
            sources = [place[c.source, c.output.name] for c in arriving]
            member = Member(units[name], buffer[: len(arriving)], self._moves(buffer, sources))
            _scale(member, arriving)
            stretch = self.values[first : first + count]
            units[name].connect(inputs, buffer, groups[name], stretch)
            self.members.append(member)
            first += count
        self._find_followers()

    def _groups(self, name: str) -> list[list[Variable]]:
        """Outputs of a unit to be read: those needed by later units, then all others used."""
        plan = self.plan
        later = set(plan.order[plan.order.index(name) :])
        leaving = [c for c in plan.connections if c.source == name]
        used = {c.output.name for c in leaving}
        used |= {variable.name for component, variable in plan.records if component == name}
        outputs = plan.interfaces[name].of("output")
        used |= {v.name for v in outputs if v.name == EVENT and v.kind == "Real"}
        soon = {c.output.name for c in leaving if c.target in later}
        return [
            [v for v in outputs if v.name in soon],
            [v for v in outputs if v.name in used and v.name not in soon],
        ]

    def _moves(self, buffer: Values, sources: list[int]) -> list[tuple[Values, Values]]:
        """Slice pairs, one for each run of neighbouring outputs."""
        moves = []
        start = 0
        for k in range(1, len(sources) + 1):
            if k == len(sources) or sources[k] != sources[k - 1] + 1:
                low = sources[start]
                moves.append((buffer[start:k], self.values[low : low + k - start]))
                start = k
        return moves

    def _find_followers(self) -> None:
        """Members with a used output that follows a wired input directly, sources first."""
        plan = self.plan
        wired = {(c.target, c.input.name): c for c in plan.connections}
        direct: dict[str, set[str]] = {}
        for name, variable in zip(
            (n.partition(".")[0] for n in self.names), self.variables, strict=True
        ):
            inputs = variable.depends
            if inputs is None:
                inputs = tuple(v.name for v in plan.interfaces[name].of("input"))
            for key in inputs:
                if (name, key) in wired:
                    direct.setdefault(name, set()).add(wired[name, key].source)
        done: list[str] = []
        waiting = [name for name in plan.order if name in direct]
        while waiting:
            ready = [n for n in waiting if not (direct[n] - {n}) & set(waiting)] or waiting[:1]
            done += ready
            waiting = [n for n in waiting if n not in ready]
        by_name = {member.unit.name: member for member in self.members}
        self.followers = [by_name[name] for name in done]
        for member in self.members:
            if member not in self.followers:
                member.unit.read_whole_at_once()

    def _initialise(self) -> None:
        """Initialisation mode of all units, with values passed until nothing changes."""
        grid = self.plan.grid
        for member in self.members:
            start = self.plan.starts[member.unit.name]
            member.unit.prepare(start, grid.start, grid.stop, None)
        for member in self.members:
            member.unit.enter_initialisation()
        self._settle()
        for member in self.members:
            member.unit.exit_initialisation()
        for member in self.members:
            member.follow()

    def _settle(self) -> None:
        """Fixed-point passes over all units; an error names the values that keep moving."""
        for member in self.members:
            member.unit.receive()
        for _ in range(MOST_PASSES):
            before = self.values.copy()
            for member in self.members:
                member.follow()
            change = np.abs(self.values - before)
            if np.all(change <= SETTLED * np.maximum(1e-30, np.abs(self.values))):
                return
            if not np.all(np.isfinite(self.values)):
                break
        worst = int(np.argmax(np.where(np.isfinite(change), change, np.inf)))
        said = [f"{m.unit.name}: {text}" for m in self.members for text in m.unit.messages[-1:]]
        raise InitialisationError(
            f"{self.plan.path}: {said[0]}"
            if said
            else f"{self.plan.path}: {self.names[worst]} = {self.values[worst]:g} does not settle"
            f" at the start (still changing by {change[worst]:.2g}); give other start values"
        )


def _scale(member: Member, arriving: list[Connection]) -> None:
    """Give a member gains and offsets only where some wire has any."""
    gain = np.array([c.gain for c in arriving])
    offset = np.array([c.offset for c in arriving])
    if np.any(gain != 1.0) or np.any(offset != 0.0):
        member.gain, member.offset = gain, offset
