"""A scenario at rest as a linear system, identified through the interfaces of its FMUs.

Each input is nudged for one sampling interval, up and down; half the difference of the
responses is the sequence of Markov parameters, free of even terms. The eigensystem
realisation (Juang and Pappa 1985) turns it into x(k+1) = A x(k) + B u(k), y(k) = C x(k) + D u(k),
and a second record, of another shape and twice as long, decides whether that is the system.

The sampling interval is a communication step, or a whole number of them: seen once a cycle, a
driven system in its periodic state is at rest, and what is found is its averaged linear model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, SimulationError
from ...scenario.patterns import matching
from ...scenario.plan import Plan
from ..coupled_instance import CoupledInstance
from ..masters import master_class
from ..stepper import Stepper
from ..system import System
from .drive import driving
from .realisation import Hankel, held_response
from .realisation import System as Triple

if TYPE_CHECKING:
    import control

Values = NDArray[np.float64]
AT_REST = 1e-9
MOST_STEPS = 100_000
WINDOW = 200
LEAST_WINDOW = 10
COUNT = 240
NUDGE = 1e-4
MARKOV = 12
"""Intervals of a response from which an averaged model is made: a cycle forgets much."""
AVERAGED = 3e-3
"""Nudge for an averaged model: far above what an edge between two steps changes."""
UNEVEN = 0.1
"""Even share of a response from which on an output is not smooth."""
UNMOVED = 1e-10
"""Response relative to the value at rest below which an output does not move."""
MATCHED = 0.02
"""Error, by the largest value, that the system may have on the second record."""
UNMATCHED = 1e-9
PERIODIC = 0.995
STUBBORN = 20
"""Windows over which the motion has to fall to this share: else nothing comes to rest."""


@dataclass(frozen=True)
class Linear:
    """A discrete linear system with named signals; `step` is its sampling interval [s].

    Inputs are held over an interval. `rest` holds the outputs at the point of linearisation,
    `units` the units of inputs and outputs, `left_out` the outputs that have no linear response,
    with the reason. `floor` is the largest error of each output on a second record, for an input
    of one: a response below it is not known. `matched` is the largest of them, relative to the
    largest value of its output.
    """

    a: Values
    b: Values
    c: Values
    d: Values
    step: float
    inputs: list[str]
    outputs: list[str]
    rest: Values
    units: dict[str, str]
    floor: Values
    left_out: dict[str, str] = field(default_factory=dict)
    matched: float = 0.0

    def eigenvalues(self) -> NDArray[np.complex128]:
        """Poles in continuous time [1/s], s = ln(lambda)/h, slowest decay first."""
        poles = np.linalg.eigvals(self.a).astype(complex)
        with np.errstate(divide="ignore"):
            slow = np.log(poles[np.abs(poles) > 0.0]) / self.step
        found: NDArray[np.complex128] = slow[np.argsort(-slow.real)]
        return found

    def state_space(self) -> control.StateSpace:
        """The same system for python-control, sampled, with the same signal names."""
        import control

        return control.ss(
            self.a, self.b, self.c, self.d, self.step,
            inputs=[plain(name) for name in self.inputs],
            outputs=[plain(name) for name in self.outputs],
        )  # fmt: skip

    def response(self, frequencies: Values) -> NDArray[np.complex128]:
        """Transfer from inputs to outputs at frequencies [Hz]: (outputs, inputs, frequencies).

        An input is a value that is held over each step.
        """
        z = np.exp(2j * np.pi * np.asarray(frequencies) * self.step)
        identity = np.eye(len(self.a))
        found = [self.c @ np.linalg.solve(one * identity - self.a, self.b) + self.d for one in z]
        return np.moveaxis(np.asarray(found), 0, -1)


def plain(name: str) -> str:
    """A signal's name without dots, which python-control does not accept."""
    return name.replace(".", "_")


def linearise(
    plan: Plan,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    *,
    count: int = COUNT,
    order: int | None = None,
    interval: float | None = None,
    nudge: float = NUDGE,
) -> Linear:
    """Linear system of a scenario about its state of rest, by its own master and step.

    `inputs` are held inputs, by default all real ones; `outputs` recorded variables, by default all
    that answer smoothly; both may be patterns. The order is that with the widest gap in the
    singular values whose system meets a second record. With `interval` [s], a whole number of
    communication steps, the system is sampled at that interval and steps end at announced events:
    an interval of one cycle gives the averaged model of a driven system about its periodic state,
    for which the outputs alone are looked at. `count` is the number of Markov parameters, `nudge`
    the size of a nudge by that of its input or 1. Raises `InputError` where an instance cannot roll
    back, where a name is not known, where the scenario does not come to rest, where an output that
    is asked for does not answer, where the interval is not a whole number of steps, and where no
    linear system meets the records.
    """
    every = _steps_in(interval, plan)
    nudged, wanted = signals(plan, inputs, outputs, driven=every > 1)
    with System(endless(plan)) as system:
        master = master_class(plan.scenario.master.kind)(system, plan.scenario.master)
        stepper = Stepper(system, master)
        held = _held(system, nudged)
        shown = _columns(system, wanted)
        time, _ = rest(system, stepper, every, shown if every > 1 else None)
        probe = _Probe(system, stepper, time, held, shown, every, nudge)
        sequence, direct, even = probe.impulses(count)
        resting = probe.resting
        left_out = _left_out(probe, sequence, direct, even, resting)
        reasons = "; ".join(f"{name} {reason}" for name, reason in left_out.items())
        kept = [i for i, k in enumerate(shown) if system.names[k] not in left_out]
        if not kept or (outputs and left_out):
            raise InputError(f"{plan.path}: not linearised: {reasons or 'nothing is recorded'}")
        second = probe.held_steps(2 * count)[:, kept]
    sequence, direct = sequence[:, kept], direct[kept]
    found, floor, matched = _matching(sequence, direct, second, order, plan)
    if left_out and not len(found[0]):
        raise InputError(f"{plan.path}: not linearised: no motion is left: {reasons}")
    columns, step = [shown[i] for i in kept], every * plan.grid.step
    units = {system.names[k]: system.variables[k].unit for k in columns} | _input_units(held)
    return Linear(
        *found, direct, step, list(held), [system.names[k] for k in columns], resting[kept], units,
        floor, left_out, matched,
    )  # fmt: skip


def signals(
    plan: Plan, inputs: Sequence[str] | None, outputs: Sequence[str] | None, *, driven: bool
) -> tuple[list[str], list[str]]:
    """Inputs to nudge, and the outputs that are wanted; none where none is named.

    Raises `InputError` with what is known before an FMU is loaded: a name that is not there, an
    instance that cannot roll back, a drive that is on where it must not be `driven`.
    """
    unable = [name for name, known in plan.interfaces.items() if not known.rollback]
    if unable:
        raise InputError(f"{plan.path}: {', '.join(unable)} cannot roll back: not linearised")
    nudged = _inputs(plan, inputs)
    wanted = matching(outputs or [], plan.record_names, "--variable", "is not recorded")
    if not driven and (drive := driving(plan)):
        raise InputError(
            f"{plan.path}: not linearised: a drive is on, so that nothing comes to rest; switch it"
            f' off by --set {drive}=0, or look at it once a cycle: --interval "1 cycle"'
        )
    return nudged, wanted


def _steps_in(interval: float | None, plan: Plan) -> int:
    """Communication steps in an interval; `InputError` where they are not a whole number."""
    if interval is None:
        return 1
    steps = interval / plan.grid.step
    if round(steps) < 1 or abs(steps - round(steps)) > UNMATCHED * steps:
        raise InputError(
            f"{plan.path}: an interval of {interval:g} s is {steps:.6g} communication steps of"
            f" {plan.grid.step:g} s; it has to be a whole number of them"
        )
    return round(steps)


def endless(plan: Plan, step: float | None = None) -> Plan:
    """The same plan with a stop time that no search for a state of rest reaches.

    An instance that is told a stop time may refuse to step beyond it.
    """
    grid = plan.grid
    count = 2 * MOST_STEPS
    stop = grid.start + count * max(grid.step, step or 0.0)
    return replace(plan, grid=replace(grid, stop=stop, count=count))


def rest(
    system: System, stepper: Stepper, every: int = 1, shown: list[int] | None = None
) -> tuple[float, Values]:
    """Step until nothing changes any more; return the time reached, and the largest values seen.

    Values are looked at after `every` steps, those in the places `shown`, or all but times.
    """
    grid = system.plan.grid
    kept = shown or [k for k in range(len(system.names)) if system.variables[k].unit != "s"]
    window = max(WINDOW // every, LEAST_WINDOW)
    largest = np.abs(system.values)
    begin = system.values[kept].copy()
    moved = np.zeros(len(kept))
    motion: list[Values] = []
    for k in range(MOST_STEPS // every):
        if k and k % window == 0:
            if np.all(moved <= AT_REST * (largest[kept] + 1e-12)):
                return grid.start + k * every * grid.step, largest
            motion = [*motion[-STUBBORN:], moved]
            worst = int(np.argmax(moved / (largest[kept] + 1e-12)))
            if len(motion) > STUBBORN and moved[worst] > PERIODIC * max(m[worst] for m in motion):
                break
            begin, moved = system.values[kept].copy(), np.zeros(len(kept))
        for n in range(k * every, (k + 1) * every):
            stepper.to(grid.start + n * grid.step, grid.start + (n + 1) * grid.step, grid.step)
        now = system.values[kept]
        np.maximum(largest, np.abs(system.values), out=largest)
        np.maximum(moved, np.abs(now - begin), out=moved)
        if not np.all(np.isfinite(now)):
            raise SimulationError(f"{system.plan.path}: leaves all bounds before it comes to rest")
    worst = int(np.argmax(moved / (largest[kept] + 1e-12)))
    hint = "; switch the drive off, as --set amplifier.amplitude=0" if every == 1 else ""
    raise InputError(
        f"{system.plan.path}: {system.names[kept[worst]]} does not come to rest in"
        f" {(k + 1) * every} steps{hint}"
    )


def _inputs(plan: Plan, wanted: Sequence[str] | None) -> list[str]:
    """Held real inputs, all or those that are wanted."""
    real = [
        f"{component}.{name}"
        for component in plan.order
        for name, known in plan.interfaces[component].variables.items()
        if known.real and f"{component}.{name}" in plan.held
    ]
    if not real:
        raise InputError(f"{plan.path}: hold: no real input is held, so that none can be nudged")
    return matching(wanted, real, "--input", "is not held") if wanted else real


def _held(system: System, wanted: Sequence[str]) -> dict[str, tuple[CoupledInstance, int]]:
    """Held inputs by name: the coupled instance and the place in its buffer."""
    found = {
        f"{coupled.instance.name}.{name}": (coupled, place)
        for coupled in system.instances
        for name, place in coupled.held.items()
    }
    return {name: found[name] for name in wanted}


def _input_units(held: dict[str, tuple[CoupledInstance, int]]) -> dict[str, str]:
    return {
        full: coupled.instance.interface.variables[full.partition(".")[2]].unit
        for full, (coupled, _) in held.items()
    }


def _columns(system: System, wanted: Sequence[str]) -> list[int]:
    """Places of the variables that are shown; by default times and energies are not."""
    if wanted:
        return [system.names.index(name) for name in wanted]
    recorded = set(system.plan.record_names)
    return [
        k
        for k, name in enumerate(system.names)
        if name in recorded and system.variables[k].unit not in {"s", "J"}
    ]


@dataclass(frozen=True)
class _Probe:
    """A system at rest whose held inputs are nudged; everything goes back to rest before each."""

    system: System
    stepper: Stepper
    time: float
    held: dict[str, tuple[CoupledInstance, int]]
    shown: list[int]
    every: int
    nudge: float

    @property
    def resting(self) -> Values:
        return self.system.values[self.shown].copy()

    def size(self, name: str) -> float:
        """Size of the nudge of an input, in its unit."""
        coupled, place = self.held[name]
        return self.nudge * max(abs(float(coupled.buffer[place])), 1.0)

    def impulses(self, count: int) -> tuple[Values, Values, Values]:
        """Markov parameters (count, outputs, inputs) from the second on, the first, D, and even.

        The last is the largest even part of each output's responses (outputs, inputs).
        """
        sequence = np.zeros((count, len(self.shown), len(self.held)))
        direct = np.zeros((len(self.shown), len(self.held)))
        even = np.zeros_like(direct)
        for column, name in enumerate(self.held):
            size = self.size(name)
            up, down = (self._response(name, sign * size, 1, count) for sign in (1.0, -1.0))
            odd = (up - down) / (2.0 * size)
            direct[:, column], sequence[:, :, column] = odd[0], odd[1:]
            even[:, column] = np.abs(up + down).max(axis=0, initial=0.0) / (2.0 * size)
        return sequence, direct, even

    def held_steps(self, count: int) -> Values:
        """Responses (count, outputs, inputs) to nudges, half as large, that stay."""
        found = np.zeros((count, len(self.shown), len(self.held)))
        for column, name in enumerate(self.held):
            size = 0.5 * self.size(name)
            found[:, :, column] = self._response(name, size, count, count - 1) / size
        return found

    def _response(self, name: str, nudge: float, lasting: int, count: int) -> Values:
        """Change of the outputs (count + 1, outputs) under a nudge that lasts some intervals."""
        system, master = self.system, self.stepper.master
        coupled, place = self.held[name]
        at, resting = float(coupled.buffer[place]), self.resting
        moment, memory = system.save(), master.remember()
        found = np.zeros((count + 1, len(self.shown)))
        for k in range(count + 1):
            if k in (0, lasting):
                coupled.buffer[place] = at + (nudge if k == 0 else 0.0)
                coupled.follow()
                system.follow()
            found[k] = system.values[self.shown] - resting
            if k < count:
                self._advance(k)
        system.restore(moment)
        master.recall(memory)
        system.forget(moment)
        return found

    def _advance(self, k: int) -> None:
        """One sampling interval, the k-th: a step as it is, or steps that end at events."""
        size = self.system.plan.grid.step
        if self.every == 1:
            self.stepper.master.advance(self.time + k * size, size)
            return
        for n in range(k * self.every, (k + 1) * self.every):
            self.stepper.to(self.time + n * size, self.time + (n + 1) * size, size)


def _left_out(
    probe: _Probe, sequence: Values, direct: Values, even: Values, resting: Values
) -> dict[str, str]:
    """Outputs without a linear response, with the reason."""
    found = {}
    sizes = np.array([probe.size(name) for name in probe.held])
    odd = np.maximum(np.abs(sequence).max(axis=0, initial=0.0), np.abs(direct))
    for row, k in enumerate(probe.shown):
        name, moved = probe.system.names[k], float((odd[row] * sizes).max(initial=0.0))
        bent = float((even[row] * sizes).max(initial=0.0))
        floor = UNMOVED * probe.nudge
        if max(moved, bent) <= floor * max(abs(float(resting[row])), probe.nudge):
            found[name] = "is not moved by any input"
        elif bent > UNEVEN * moved:
            found[name] = "is not smooth: it answers nudges up and down alike"
    return found


def _matching(
    sequence: Values, direct: Values, second: Values, order: int | None, plan: Plan
) -> tuple[Triple, Values, float]:
    """The system of the likeliest order that meets a second record, and its errors there.

    These are the largest of each output, and the largest of all relative to its output's size.
    """
    hankel = Hankel(sequence)
    size = np.abs(second).max(axis=(0, 2), initial=0.0)
    scale = np.where(size > 0.0, size, 1.0)
    best = np.inf
    for tried in hankel.orders() if order is None else [order]:
        found = hankel.system(tried)
        with np.errstate(over="ignore", invalid="ignore"):
            miss = np.abs(held_response(found, direct, len(second)) - second).max(axis=(0, 2))
        error = float((miss / scale).max(initial=0.0))
        if error <= MATCHED or order is not None:
            return found, miss, error
        best = min(best, error)
    raise InputError(
        f"{plan.path}: not linearised: no linear system meets a second record better than to"
        f" {best:.1%}; choose outputs by --variable, or another state of rest"
    )
