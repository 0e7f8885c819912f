"""A scenario at rest as a linear system, identified through the interfaces of its FMUs.

Each input is nudged for one communication step, up and down; half the difference of the
responses is the sequence of Markov parameters, free of even terms. The eigensystem
realisation (Juang and Pappa 1985) turns it into x(k+1) = A x(k) + B u(k), y(k) = C x(k) + D u(k).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, SimulationError
from ...scenario.plan import Plan
from ..masters import Master, master_class
from ..stepper import Stepper
from ..system import System

if TYPE_CHECKING:
    import control

Values = NDArray[np.float64]
AT_REST = 1e-9
MOST_STEPS = 200_000
WINDOW = 200
COUNT = 240
NUDGE = 1e-4
SMALLEST = 1e-9
"""Singular value, relative to the largest, below which there is only noise."""


@dataclass(frozen=True)
class Linear:
    """A discrete linear system with named signals; `step` is its sampling time [s].

    Inputs are held over a step. `rest` holds the outputs at the point of linearisation.
    """

    a: Values
    b: Values
    c: Values
    d: Values
    step: float
    inputs: list[str]
    outputs: list[str]
    rest: Values

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
) -> Linear:
    """Linear system of a scenario about its state of rest, by its own master and step.

    `inputs` are held inputs, by default all real ones; `outputs` recorded variables. Raises
    `InputError` where an instance cannot roll back, where a name is not known, and where the
    scenario does not come to rest.
    """
    unable = [name for name, known in plan.interfaces.items() if not known.rollback]
    if unable:
        raise InputError(f"{plan.path}: {', '.join(unable)} cannot roll back: not linearised")
    with System(plan) as system:
        master = master_class(plan.scenario.master.kind)(system, plan.scenario.master)
        stepper = Stepper(system, master)
        time, _ = rest(system, stepper)
        held = _held(system, inputs)
        shown = _columns(system, outputs)
        sequence, direct = _markov(system, master, time, held, shown, count)
        resting = system.values[shown].copy()
    a, b, c = realise(sequence, order)
    names = [system.names[k] for k in shown]
    return Linear(a, b, c, direct, plan.grid.step, list(held), names, resting)


def rest(system: System, stepper: Stepper) -> tuple[float, Values]:
    """Step until nothing changes any more; return the time reached, and the largest values seen."""
    grid = system.plan.grid
    kept = [k for k in range(len(system.names)) if system.variables[k].unit != "s"]
    largest = np.abs(system.values)
    begin = system.values[kept].copy()
    moved = np.zeros(len(kept))
    for k in range(MOST_STEPS):
        time = grid.start + k * grid.step
        if k and k % WINDOW == 0:
            if np.all(moved <= AT_REST * (largest[kept] + 1e-12)):
                return time, largest
            begin, moved = system.values[kept].copy(), np.zeros(len(kept))
        stepper.to(time, grid.start + (k + 1) * grid.step, grid.step)
        now = system.values[kept]
        np.maximum(largest, np.abs(system.values), out=largest)
        np.maximum(moved, np.abs(now - begin), out=moved)
        if not np.all(np.isfinite(now)):
            raise SimulationError(f"{system.plan.path}: leaves all bounds before it comes to rest")
    worst = int(np.argmax(moved / (largest[kept] + 1e-12)))
    raise InputError(
        f"{system.plan.path}: {system.names[kept[worst]]} does not come to rest in {MOST_STEPS}"
        " steps; switch the drive off, as --set amplifier.amplitude=0"
    )


def _held(system: System, wanted: Sequence[str] | None) -> dict[str, tuple[Any, int]]:
    """Held real inputs by name: the coupled instance and the place in its buffer."""
    found = {
        f"{coupled.instance.name}.{name}": (coupled, place)
        for coupled in system.instances
        for name, place in coupled.held.items()
        if coupled.instance.interface.variables[name].real
    }
    if not found:
        raise InputError(
            f"{system.plan.path}: hold: no real input is held, so that none can be nudged"
        )
    for name in wanted or []:
        if name not in found:
            raise InputError(f"--input {name}: is not held; there is {', '.join(found)}")
    return {name: found[name] for name in wanted} if wanted else found


def _columns(system: System, wanted: Sequence[str] | None) -> list[int]:
    """Places of the recorded variables that are shown; by default times and energies are not."""
    recorded = [f"{name}.{v.name}" for name, v in system.plan.records]
    for name in wanted or []:
        if name not in recorded:
            raise InputError(f"--output {name}: is not recorded; there is {', '.join(recorded)}")
    if wanted:
        return [system.names.index(name) for name in wanted]
    shown = set(recorded)
    return [
        k
        for k, name in enumerate(system.names)
        if name in shown and system.variables[k].unit not in {"s", "J"}
    ]


def _markov(
    system: System, master: Master, time: float, held: dict[str, tuple[Any, int]],
    shown: list[int], count: int,
) -> tuple[Values, Values]:  # fmt: skip
    """Markov parameters (count, outputs, inputs) from the second on, and the first, D."""
    moment, memory = system.save(), master.remember()
    sequence = np.zeros((count, len(shown), len(held)))
    direct = np.zeros((len(shown), len(held)))
    for column, (coupled, place) in enumerate(held.values()):
        at = coupled.buffer[place]
        size = NUDGE * max(abs(float(at)), 1.0)
        for sign in (1.0, -1.0):
            system.restore(moment)
            master.recall(memory)
            coupled.buffer[place] = at + sign * size
            coupled.follow()
            system.follow()
            direct[:, column] += sign * system.values[shown]
            for k in range(count):
                master.advance(time + k * system.plan.grid.step, system.plan.grid.step)
                if k == 0:
                    coupled.buffer[place] = at
                    coupled.follow()
                    system.follow()
                sequence[k, :, column] += sign * system.values[shown]
        sequence[:, :, column] /= 2.0 * size
        direct[:, column] /= 2.0 * size
    system.restore(moment)
    system.forget(moment)
    return sequence, direct


def realise(
    sequence: Values, order: int | None = None, smallest: float = SMALLEST
) -> tuple[Values, Values, Values]:
    """A, B, C whose Markov parameters C A^k B are a sequence (count, outputs, inputs).

    Rows are scaled to like size here; the caller should scale columns by the usual size of each
    input, so that a weak response is not taken for noise, or noise for a response. Where the order
    is not given, it is the number of singular values of the Hankel matrix above `smallest` of the
    largest.
    """
    count, rows, columns = sequence.shape
    size = np.abs(sequence).max(axis=(0, 2))
    size = np.where(size > 0.0, size, 1.0)
    scaled = sequence / size[None, :, None]
    half = count // 2
    hankel = np.block([[scaled[i + j] for j in range(half)] for i in range(half)])
    shifted = np.block([[scaled[i + j + 1] for j in range(half)] for i in range(half)])
    left, values, right = np.linalg.svd(hankel, full_matrices=False)
    if order is None:
        order = int(np.sum(values > smallest * values[0])) if values[0] > 0.0 else 0
    root = np.sqrt(values[:order])
    first, last = left[:, :order], right[:order]
    a = (first / root).T @ shifted @ (last.T / root)
    b = (root[:, None] * last)[:, :columns]
    c = (first * root)[:rows] * size[:, None]
    return np.asarray(a), np.asarray(b), np.asarray(c)
