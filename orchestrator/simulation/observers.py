"""What observes a run and never changes it: a user's observers, the recorder, the guard, the bar.

The run calls each :class:`Watcher` with the whole system. What a user gives to `run` is an
:class:`Observer`; :class:`Observed` is the one place where it meets the system.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from time import perf_counter
from types import MappingProxyType
from typing import NoReturn, Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import Divergence, InputError, ObserverError
from ..fmi.description import Variable
from ..scenario.plan import Plan
from .system import System
from .view import View

Values = NDArray[np.float64]


class Observer(Protocol):
    """Observes a run that it is given to, as `run(plan, observers=[...])`.

    Subclass it and write `sample`; a class with both methods does as well. Observers are called
    one after the other, in the order of the list, in the process of the master.

    An observer reads. The view has no way to the instances, so the rows of a run are the same
    bits with and without observers. An exception ends the run: the outcome carries it as an
    :class:`~orchestrator.errors.ObserverError` that names the observer, and keeps the rows up to
    and including the communication point at which it came.
    """

    def start(self, plan: Plan, variables: Mapping[str, Variable]) -> None:
        """Called once, after the instances have been initialised and before the first `sample`.

        `variables` describes what the view will hold: `component.variable` to its unit of
        measure and description. Does nothing where it is not overridden.
        """

    @abstractmethod
    def sample(self, view: View) -> None:
        """Called at the start, then at each communication point, when the values hold there.

        On a grid these are its points, whatever `record.every` and `record.last` keep; steps that
        are cut at an event or a timed action end at the grid's point. With a tolerance they are
        the ends of accepted steps: no attempt that was rejected is ever seen. The second run of an
        error estimate is not observed. Where a value leaves its bounds the run has stopped before.
        """


class Watcher(Protocol):
    """Called with the system at each communication point, after the values hold there."""

    def sample(self, system: System, step: int, time: float) -> None: ...


def check_observers(observers: Sequence[Observer]) -> None:
    """Refuse what is not a list of observers, before anything is loaded; `InputError`."""
    if not isinstance(observers, Sequence):
        raise InputError(
            f"observers: expected a list of observers, got one {type(observers).__name__};"
            " write observers=[...]"
        )
    for index, observer in enumerate(observers):
        lacking = [n for n in ("start", "sample") if not callable(getattr(observer, n, None))]
        if lacking or isinstance(observer, type):
            what = observer.__name__ if isinstance(observer, type) else type(observer).__name__
            why = "is a class; give an instance of it"
            if lacking:
                why = f"has no method {' and no '.join(lacking)}; subclass orchestrator.Observer"
            raise InputError(f"observers[{index}]: {what} {why}")


class Observed:
    """A user's observers as one watcher: they get a view in the place of the system."""

    def __init__(self, system: System, observers: Sequence[Observer]) -> None:
        self._observers = list(observers)
        self._view = View(system)
        variables = dict(zip(system.names, system.variables, strict=True))
        self._variables = MappingProxyType(variables)

    def sample(self, system: System, step: int, time: float) -> None:
        self._view._move(step, time)
        if step == 0:
            for index, observer in enumerate(self._observers):
                try:
                    observer.start(system.plan, self._variables)
                except Exception as error:
                    raise self._failed(index, "start", error) from error
        for index, observer in enumerate(self._observers):
            try:
                observer.sample(self._view)
            except Exception as error:
                raise self._failed(index, "sample", error) from error

    def _failed(self, index: int, method: str, error: Exception) -> ObserverError:
        """The error that names the observer, the time and what it raised."""
        text = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
        return ObserverError(
            f"observers[{index}] ({type(self._observers[index]).__name__}): {method} raised"
            f" {type(error).__name__} at t = {self._view.time:.9g} s: {text}"
        )


class Sink(Protocol):
    """Takes the rows of a long run off memory, as `Segments` do."""

    def write(self, times: Values, rows: Values) -> None: ...


class Memory:
    """Where rows are in memory: arrays that are replaced by longer ones, with the same rows."""

    def extended(self, times: Values, rows: Values, length: int) -> tuple[Values, Values]:
        """Times and rows of this length, which begin with the given ones."""
        more_times, more_rows = np.empty(length), np.empty((length, rows.shape[1]))
        more_times[: len(times)], more_rows[: len(rows)] = times, rows
        return more_times, more_rows


class Recorder:
    """Rows of the recorded values, each stamped with the time at which it holds.

    With `segments`, rows are moved from memory to disk in closed segments: when `SEGMENT` bytes
    are full, and at the latest every `PATIENCE` seconds.
    """

    SEGMENT = 16 << 20
    PATIENCE = 60.0

    def __init__(
        self,
        system: System,
        every: int,
        segments: Sink | None = None,
        memory: Memory | None = None,
    ) -> None:
        place = {name: index for index, name in enumerate(system.names)}
        self.names = system.plan.record_names
        self._columns = np.array([place[name] for name in self.names], dtype=np.intp)
        self.every = every
        self.begin = system.plan.keep_from
        self._segments = segments
        self._full = max(256, self.SEGMENT // (8 * (len(self.names) + 1)))
        self._written = perf_counter()
        expected = system.plan.grid.count // every + 2
        self._memory = memory or Memory()
        self._times: Values = np.empty(0)
        self._rows: Values = np.empty((0, len(self.names)))
        self._grow(min(expected, 1 << 14))
        self.count = 0

    def sample(self, system: System, step: int, time: float) -> None:
        if step % self.every or time < self.begin:
            return
        if self.count == len(self._times):
            self._grow(2 * self.count)
        np.take(system.values, self._columns, out=self._rows[self.count])
        self._times[self.count] = time
        self.count += 1
        if self._segments is not None and self.count % 256 == 0:
            self.write_if_late()

    def _grow(self, length: int) -> None:
        self._times, self._rows = self._memory.extended(self._times, self._rows, length)

    def make_room(self) -> None:
        """Have room for at least one more row: in memory, or by closing a segment."""
        self.write_if_late()
        if self.count == len(self._times):
            self._grow(2 * self.count)

    def write_if_late(self) -> bool:
        """Close a segment where one is full or due; whether rows have left memory."""
        if self._segments is None or not self.count:
            return False
        late = perf_counter() - self._written > self.PATIENCE
        if self.count < self._full and not late:
            return False
        self._segments.write(self.times, self.rows)
        self._written = perf_counter()
        self.count = 0
        return True

    @property
    def room(self) -> int:
        """Rows that memory holds before some have to leave it or it has to grow."""
        full = len(self._times)
        return full if self._segments is None else min(full, self._full)

    @property
    def arrays(self) -> tuple[Values, Values, NDArray[np.intp]]:
        """Times, rows and the recorded places of the system's values, as they are in memory."""
        return self._times, self._rows, self._columns

    @property
    def times(self) -> Values:
        """Times of the rows in memory [s]."""
        return self._times[: self.count]

    @property
    def rows(self) -> Values:
        """Recorded values in memory, one row per time."""
        return self._rows[: self.count]


class Guard:
    """Stops a run whose values have ceased to mean anything.

    It looks at every point for NaN, infinity, and values outside the bounds that their FMU
    declares (1e100 where it declares none). With `growth`, which needs equal steps, it looks every
    `WINDOW` points for a wired value whose peak has at least doubled in `WINDOWS` windows in a row.
    No vibration that settles does that, however it starts (a growth as t^n doubles over eight
    windows only for n above 5).
    """

    WINDOW = 25
    WINDOWS = 8
    BOUND = 1e100

    def __init__(self, system: System, growth: bool = True) -> None:
        variables = system.variables
        self.every = self.WINDOW if growth else 0
        self.high = np.array([self.BOUND if v.most is None else v.most for v in variables])
        self.low = np.array([-self.BOUND if v.least is None else v.least for v in variables])
        wired = {
            f"{c.source}.{c.output.name}" for c in system.plan.connections if not c.output.order
        }
        self.wired = np.array([name in wired for name in system.names])
        self.peak = np.zeros(len(variables))
        self.previous = np.zeros(len(variables))
        self.growing = np.zeros(len(variables), dtype=np.int64)
        self.count = 0

    def sample(self, system: System, step: int, time: float) -> None:
        values = system.values
        if not ((values <= self.high).all() and (values >= self.low).all()):
            self.stop_out_of_bounds(system, time)
        if not self.every:
            return
        np.maximum(self.peak, np.abs(values), out=self.peak)
        self.count += 1
        if self.count % self.every == 0:
            self._compare(system, time)

    def _compare(self, system: System, time: float) -> None:
        """Close a window: add to the count where the peak has doubled, reset it elsewhere."""
        doubled = (self.peak >= 2.0 * self.previous) & (self.previous > 0.0)
        self.growing[:] = np.where(doubled & self.wired, self.growing + 1, 0)
        if (self.growing >= self.WINDOWS).any():
            self.stop_growth(system, time)
        self.previous[:] = self.peak
        self.peak[:] = 0.0

    def stop_growth(self, system: System, time: float) -> NoReturn:
        """Raise `Divergence` for the value that has doubled for longest."""
        index = int(np.argmax(self.growing))
        raise Divergence(
            f"{system.names[index]} grows without end: {self.peak[index]:.3g}"
            f" {system.variables[index].unit} at t = {time:.6g} s, doubling every"
            f" {self.WINDOW} steps; lower the step or use laws"
        )

    def stop_out_of_bounds(self, system: System, time: float) -> NoReturn:
        """Raise `Divergence` for the first value that is outside of its bounds, or not finite."""
        values = system.values
        bad = ~((values <= self.high) & (values >= self.low))
        index = int(np.argmax(bad))
        name, value = system.names[index], float(values[index])
        unit = system.variables[index].unit
        if np.isfinite(value):
            low, high = self.low[index], self.high[index]
            what = f"is outside {low:g} to {high:g} {unit}"
        else:
            what = "is not a finite number"
        raise Divergence(
            f"{name} = {value:g} {unit} at t = {time:.9g} s {what}; last message:"
            f" {_last_message(system, name)}"
        )


def _last_message(system: System, name: str) -> str:
    """The last message that the instance of a value has logged, or `none`."""
    instance = name.partition(".")[0]
    logs = [m.instance.messages for m in system.instances if m.instance.name == instance]
    return logs[0][-1] if logs and logs[0] else "none"


class Progress:
    """A bar on the terminal, shown once a run has lasted longer than `PATIENCE` [s]."""

    PATIENCE = 1.0

    def __init__(self, plan: Plan) -> None:
        self._stop = plan.grid.count
        self._begun = perf_counter()
        self._next = 0
        self._bar: object | None = None

    def sample(self, system: System, step: int, time: float) -> None:
        self.move(step)

    def move(self, step: int) -> None:
        """Show how many steps have been taken."""
        if step < self._next:
            return
        self._next = step + max(1, self._stop // 200)
        if self._bar is None and perf_counter() - self._begun > self.PATIENCE:
            self._open()
        if self._bar is not None:
            self._bar.update(self._task, completed=step)  # type: ignore[attr-defined]

    def _open(self) -> None:
        from rich.console import Console
        from rich.progress import Progress as Bar

        bar = Bar(console=Console(stderr=True), transient=True)
        self._task = bar.add_task("running", total=self._stop)
        bar.start()
        self._bar = bar

    def close(self) -> None:
        """Take the bar off the terminal."""
        if self._bar is not None:
            self._bar.stop()  # type: ignore[attr-defined]
            self._bar = None
