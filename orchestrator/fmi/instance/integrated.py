"""An FMU for model exchange, which CVODE takes through each communication step.

Between steps the instance is in event mode, where every input may be set and every output read. A
step begins with the events that its inputs or the time have brought about, goes on in continuous
time with the inputs held or rising evenly, and ends in event mode again. State events are found by
CVODE where an event indicator changes its sign; time events are stepped to. Each step starts CVODE
anew, since inputs jump between steps, so a master may go back to any saved state.
"""

from __future__ import annotations

import ctypes
from abc import abstractmethod
from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np

from ...errors import FmuError, InstanceFailure, printable
from .base import Values
from .in_process import InProcessInstance
from .restart import Restart

TOLERANCE = 1.0e-10
"""Relative tolerance of CVODE, and absolute by the states' nominal values.

An error of this size is made in every communication step, so it has to be far below that of the
coupling over thousands of them.
"""
MOST_STEPS = 100_000
"""Internal steps of CVODE in a communication step."""
MOST_EVENTS = 100
"""Rounds in which the values of one event have to settle."""
MOST_STOPS = 10_000
"""Events in one communication step: beyond them the model does not get on."""
GRAIN = 1.0e-12
"""Share of a communication step that is no step any more."""
POINTER = ctypes.c_void_p
COUNT = ctypes.c_size_t
ERROR = 3


class Held:
    """Inputs during a step, as fmpy's solver asks for them: they come with the time."""

    def apply(self, time: float) -> None:
        """Nothing to do."""


class Integrated(InProcessInstance):
    """What model exchange adds to an instance, whatever its version of FMI.

    `_do_step` is a function that C can call too, so that the compiled loop steps such an instance
    like any other.
    """

    RATES: str
    """Name of the function that gives the derivatives of the states."""
    FLAG: Any
    """C type of true and false."""

    def __init__(self, *arguments: Any) -> None:
        self._worst = 0
        self._next_event = inf
        self._solver: Any = None
        self._begin = self._time = 0.0
        self.events = 0
        self._first = self._rates = self._level = np.zeros(0)
        self._put: Callable[[], int] | None = None
        super().__init__(*arguments)
        self._restart = Restart(self) if self.interface.restarts else None
        self._solver_class = self._cvode()

    def exit_initialisation(self) -> None:
        super().exit_initialisation()  # type: ignore[safe-super]
        self._time = self._now
        self._settle()

    def _state_function(self, verb: str) -> Any:
        """The FMU's own function, or ours where it has none."""
        own = super()._state_function  # type: ignore[safe-super]
        return own(verb) if self._restart is None else self._restart.function(verb)

    def here(self) -> tuple[float, Values, int]:
        """Time [s], continuous states, and how many events have been."""
        values = np.empty(self._sizes()[0])
        get = self._named("GetContinuousStates", POINTER, POINTER, COUNT)
        self._call(get, values.ctypes.data, len(values))
        return self._time, values, self.events

    def begin_at(self, time: float, states: Values) -> None:
        """Go to a time with these continuous states; all else stays what it is."""
        self._rates = np.zeros(0)
        self._call(self._named("EnterContinuousTimeMode", POINTER))
        self._set_time(time)
        put = self._named("SetContinuousStates", POINTER, POINTER, COUNT)
        self._call(put, states.ctypes.data, len(states))
        self._call(self._named("EnterEventMode", POINTER))
        self._settle()
        self._time = time

    def incline(self, rates: Values) -> None:
        """A step that is made here sets the inputs to what they are wherever it sets the time."""
        some = rates[self._rising]
        self._first = self._given[self._rising].copy()
        self._rates = some if some.any() else np.zeros(0)

    def _rise(self, time: float) -> None:
        """Set the inputs that rise to what they are at a time [s]."""
        if self._put is None:
            kind = "Real" if self.PREFIX == "fmi2" else "Float64"
            self._level = np.zeros(len(self._rising))
            self._put = self._bind("Set", kind, list(self._rising_references), self._level)
        np.multiply(self._rates, time - self._begin, out=self._level)
        self._level += self._first
        status = self._put()
        self._worst = max(self._worst, status if status > 1 else 0)

    def stepped(self, time: float, size: float) -> int:
        """Status of a step from `time` [s]; what goes wrong is a message, as in an FMU's own."""
        try:
            self._integrate(time, size)
        except InstanceFailure as error:
            self.log(ERROR, str(error).partition(": ")[2])
            return ERROR
        except Exception as error:  # nothing may leave a function that C calls
            self.log(ERROR, printable(f"{type(error).__name__}: {error}"))
            return ERROR
        return 0

    def _integrate(self, time: float, size: float) -> None:
        end = time + size
        least = GRAIN * size
        self._begin = time
        self._set_time(time)
        self._settle()
        now, stops = time, 0
        while now < end - least:
            self._call(self._named("EnterContinuousTimeMode", POINTER))
            solver = self._at(now)
            goal = min(end, self._next_event) if self._next_event > now + least else end
            event = False
            while not event and now < goal - least:
                event, _, now = solver.step(now, goal)
                if self._worst:
                    raise InstanceFailure(f"{self.name}: status {self._worst} inside CVODE")
                self._set_time(now)
                event = self._completed() or event
            if now >= goal - least:
                now = goal
                self._set_time(now)
            self._call(self._named("EnterEventMode", POINTER))
            self.events += event or self._next_event <= now + least
            self._settle()
            stops += 1
            if stops > MOST_STOPS:
                raise InstanceFailure(
                    f"{self.name}: more than {MOST_STOPS} events up to t = {now:.9g} s: the model"
                    " does not get on"
                )
        self._time = end

    def _at(self, time: float) -> Any:
        """CVODE at a time, from the states that the instance has now."""
        self._worst = 0
        if self._solver is None:
            self._solver = self._made(time)
        else:
            self._solver.reset(time)
        return self._solver

    def _cvode(self) -> Any:
        """fmpy's interface to CVODE; `FmuError` where there is none for this platform."""
        try:
            from fmpy.sundials import CVodeSolver
        except Exception as error:
            raise FmuError(
                f"{self.interface.path}: is for model exchange, and fmpy has no CVODE for this"
                f" platform ({printable(str(error))}); export it for co-simulation"
            ) from None
        return CVodeSolver

    def _made(self, time: float) -> Any:
        states, indicators = self._sizes()
        return self._solver_class(
            nx=states,
            nz=indicators,
            get_x=self._watched("GetContinuousStates"),
            set_x=self._watched("SetContinuousStates"),
            get_dx=self._watched(self.RATES),
            get_z=self._watched("GetEventIndicators"),
            get_nominals=self._watched("GetNominalsOfContinuousStates"),
            set_time=self._set_time,
            input=Held(),
            startTime=time,
            relativeTolerance=TOLERANCE,
            maxNumSteps=MOST_STEPS,
        )

    def _named(self, name: str, *types: Any) -> Any:
        return self._function(f"{self.PREFIX}{name}", *types)

    def _watched(self, name: str) -> Any:
        """A function over a vector for CVODE, which asks for no status: the worst is kept."""
        function = self._named(name, POINTER, POINTER, COUNT)

        def call(values: Any, count: int) -> None:
            status = function(self._instance, ctypes.cast(values, POINTER), count)
            self._worst = max(self._worst, status if status > 1 else 0)

        return call

    def _set_time(self, time: float) -> None:
        status = self._named("SetTime", POINTER, ctypes.c_double)(self._instance, time)
        self._worst = max(self._worst, status if status > 1 else 0)
        if len(self._rates):
            self._rise(time)

    def _completed(self) -> bool:
        """Tell of a step of the integrator; whether the FMU wants event mode."""
        event, ends = self.FLAG(), self.FLAG()
        told = self._named("CompletedIntegratorStep", POINTER, self.FLAG, POINTER, POINTER)
        self._call(told, True, ctypes.addressof(event), ctypes.addressof(ends))
        self._go_on(ends.value)
        return bool(event.value)

    def _go_on(self, ends: bool) -> None:
        """`InstanceFailure` where the FMU requests the end."""
        if ends:
            raise InstanceFailure(f"{self.name}: the FMU requests the end of the simulation")

    def _settle(self) -> None:
        """Iterate the event until no value changes; learn the time of the next one."""
        for _ in range(MOST_EVENTS):
            again, ends, following = self._updated()
            self._go_on(ends)
            self._next_event = following
            if not again:
                return
        raise InstanceFailure(f"{self.name}: an event does not settle in {MOST_EVENTS} rounds")

    @abstractmethod
    def _sizes(self) -> tuple[int, int]:
        """Numbers of continuous states and of event indicators."""

    @abstractmethod
    def _updated(self) -> tuple[bool, bool, float]:
        """One round of an event: whether another is needed, the end, the next event's time [s]."""
