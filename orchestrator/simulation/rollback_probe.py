"""Whether FMUs that say that they can go back to a saved state do so: tried before the first step.

One that claims it and does not makes every method that rolls back wrong without a word: its steps
add up with each attempt.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ..errors import InitialisationError, InstanceFailure
from ..fmi.instance import InProcessInstance
from .coupled_instance import CoupledInstance, Values
from .masters import master_class
from .system import System

MOST_STEPS = 20
"""Steps that are tried until an output changes; one that rests for longer is not judged."""
MISS = 0.01
"""Share of that change by which an output may differ once the FMU has gone back."""


class Spent(Exception):
    """An instance that was tried cannot be used any more: its FMU has crashed, or is no use."""


def check_rollback(system: System, points: Sequence[float] | None) -> None:
    """Try each foreign FMU where the run, over its own points or given ones, relies on rollback.

    With outputs y at the start and y' after steps with the inputs held, it has to be at y after
    going back, and at y' after the same steps again, each within `MISS` of |y' - y|. Raises
    `InitialisationError` for one that is not, and `Spent` where the run has to take new instances;
    a step that fails is the run's to report.
    """
    plan = system.plan
    adaptive = plan.scenario.time.tolerance is not None and points is None and plan.rolls_back
    if not (adaptive or master_class(plan.scenario.master.kind).needs_rollback):
        return
    for coupled in system.instances:
        interface = coupled.instance.interface
        if not interface.ours and interface.rollback:
            _check(system, coupled, plan.grid.step)


def _check(system: System, coupled: CoupledInstance, size: float) -> None:
    instance = coupled.instance
    counted = instance.steps, instance.rollbacks, instance.warned
    values = system.values[coupled.stretch]
    before = values.copy()
    tried = None
    try:
        state = instance.save()
        with suppress(InstanceFailure):
            tried = _tried(system, coupled, state, size)
        instance.restore(state)
        instance.receive()
        instance.forget(state)
    except InstanceFailure:
        raise Spent from None
    instance.steps, instance.rollbacks, instance.warned = counted
    if isinstance(instance, InProcessInstance) and instance.place is not None:
        instance.place.steps, instance.place.rollbacks = counted[:2]
    if tried is None:
        return
    after, back, again = tried
    values[:] = before
    allowed = MISS * np.abs(after - before)
    for found, wanted, when in ((back, before, "after going back"), (again, after, "in a repeat")):
        _compare(system, coupled, found, wanted, allowed, when)


def _tried(
    system: System, coupled: CoupledInstance, state: Any, size: float
) -> tuple[Values, Values, Values]:
    """Outputs after some steps, after going back, and after the same steps again."""
    values, start = system.values[coupled.stretch], system.plan.grid.start
    before = values.copy()
    taken = 0
    while taken < MOST_STEPS and np.array_equal(values, before, equal_nan=True):
        _step(coupled, start + taken * size, size)
        taken += 1
    after = values.copy()
    coupled.instance.restore(state)
    coupled.instance.receive()
    back = values.copy()
    for k in range(taken):
        _step(coupled, start + k * size, size)
    return after, back, values.copy()


def _step(coupled: CoupledInstance, time: float, size: float) -> None:
    coupled.instance.step(time, size)
    coupled.instance.receive()


def _compare(
    system: System,
    coupled: CoupledInstance,
    found: Values,
    wanted: Values,
    allowed: Values,
    when: str,
) -> None:
    missed = np.abs(found - wanted)
    if not (missed > allowed).any():
        return
    place = int(np.argmax(missed - allowed))
    name = coupled.instance.name
    raise InitialisationError(
        f"{system.plan.path}: components.{name}: its FMU says that it can go back to a saved state,"
        f" but {when} {system.names[coupled.stretch.start + place]} is {found[place]:.6g} and was"
        f" {wanted[place]:.6g}; write rollback = false there, which leaves the masters that do"
        " without: gauss-seidel, jacobi, extrapolated"
    )
