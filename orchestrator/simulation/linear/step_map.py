"""The map from one communication point to the next, linear about rest, and its spectral radius.

Every instance is identified alone, with its inputs held over a step; the models are then composed
in the way in which a master steps the instances. The spectral radius of the whole predicts, before
anything is run, whether the coupling is stable at this step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...scenario.plan import Plan
from ..coupled_instance import CoupledInstance
from ..masters import master_class
from ..stepper import Stepper
from ..system import Moment, System
from .realisation import realise
from .state_space import NUDGE, endless, plain, rest

if TYPE_CHECKING:
    import control

Values = NDArray[np.float64]
COUNT = 24
"""Steps of an instance's response: an instance alone has few states."""
NOISE = 1e-7
DOUBTFUL = 1e-3
"""Disagreement of two nudges, relative, above which an output's response is rounding."""
UNKNOWN = 1e-2
"""Size taken for a value that has always been zero."""
REFRESHED = 3
"""Steps of the size in question taken at rest, for instances that remember the last one."""
MAPPED = ("gauss-seidel", "jacobi")
SLACK = 1e-6
"""How far above one a spectral radius may lie by rounding: undamped motion has exactly one."""


@dataclass(frozen=True)
class InstanceModel:
    """One instance: x+ = A x + B u, y = C x + D u, and its wiring u = W y from all outputs.

    Right after a step, before the clocks of its inputs have moved on, y = C x + E u.
    """

    name: str
    inputs: list[str]
    outputs: list[str]
    a: Values
    b: Values
    c: Values
    d: Values
    e: Values
    wires: Values
    rows: NDArray[np.intp]

    def state_space(self, step: float) -> control.StateSpace:
        """The instance for python-control, sampled at a step [s]; signals are named by `plain`."""
        import control

        return control.ss(
            self.a, self.b, self.c, self.d, step, name=self.name,
            inputs=[plain(f"{self.name}.{name}") for name in self.inputs],
            outputs=[plain(name) for name in self.outputs],
        )  # fmt: skip


@dataclass(frozen=True)
class StepMap:
    """Instances of a scenario as linear systems at one communication step [s]."""

    plan: Plan
    step: float
    models: list[InstanceModel]
    outputs: list[str]
    followers: list[str]

    def matrix(self, kind: str, cut: str | None = None) -> Values:
        """The map of a master on (states of all instances, outputs of all instances).

        With `cut`, a `source -> target` pair of instances, the connections between them are left
        out.
        """
        if kind not in MAPPED:
            raise InputError(f"--master {kind}: its step has no map; there is {', '.join(MAPPED)}")
        sizes = [len(model.a) for model in self.models]
        starts = np.concatenate([[0], np.cumsum(sizes)]).astype(int)
        count = int(starts[-1]) + len(self.outputs)
        whole = np.eye(count)
        states = [whole[starts[i] : starts[i + 1]] for i in range(len(self.models))]
        values = whole[starts[-1] :].copy()
        wires = [self._wires(model, cut) for model in self.models]
        before = values.copy()
        for i, model in enumerate(self.models):
            u = wires[i] @ (before if kind == "jacobi" else values)
            states[i] = model.a @ states[i] + model.b @ u
            values[model.rows] = model.c @ states[i] + model.e @ u
        for i, model in enumerate(self.models):
            if model.name in self.followers:
                values[model.rows] = model.c @ states[i] + model.d @ (wires[i] @ values)
        return np.vstack([*states, values])

    def _wires(self, model: InstanceModel, cut: str | None) -> Values:
        if cut is None or not cut.endswith(f" -> {model.name}"):
            return model.wires
        source = cut.removesuffix(f" -> {model.name}")
        kept = np.array([not name.startswith(f"{source}.") for name in self.outputs])
        left: Values = model.wires * kept[None, :]
        return left

    def interconnected(self) -> control.StateSpace:
        """The instances joined by the scenario's wires in python-control; no input is left open.

        Every instance takes the outputs of the others at the same communication point, as under
        Jacobi: the poles are those of :meth:`matrix` with "jacobi".
        """
        import control

        blocks = [model.state_space(self.step) for model in self.models if model.outputs]
        wires = [
            [plain(f"{m.name}.{name}"), *((plain(self.outputs[k]), float(row[k])) for k in used)]
            for m in self.models
            if m.outputs
            for name, row in zip(m.inputs, m.wires, strict=True)
            for used in [np.flatnonzero(row)]
        ]
        summed = [
            control.summing_junction(
                [f"{source}_to_{target}" for source, _ in sources], target, name=f"into_{target}"
            )
            for target, *sources in wires
        ]
        gains = [
            control.ss([], [], [], [[gain]], self.step, inputs=[source],
                       outputs=[f"{source}_to_{target}"], name=f"{source}_to_{target}")
            for target, *sources in wires
            for source, gain in sources
        ]  # fmt: skip
        return control.interconnect(
            [*blocks, *gains, *summed], inputs=[], outputs=[plain(name) for name in self.outputs]
        )

    def radius(self, kind: str, cut: str | None = None) -> float:
        """Largest magnitude of the map's eigenvalues: above one the coupling is unstable."""
        return float(np.abs(np.linalg.eigvals(self.matrix(kind, cut))).max(initial=0.0))

    def culprit(self, kind: str) -> str:
        """The connection without which the map is most stable."""
        plan = self.plan
        pairs = list(dict.fromkeys(f"{c.source} -> {c.target}" for c in plan.connections))
        return min(pairs, key=lambda pair: self.radius(kind, pair))


def step_map(plan: Plan, step: float | None = None, *, count: int = COUNT) -> StepMap:
    """Linear models of a scenario's instances about rest, at its own communication step or another.

    Raises `InputError` where an instance cannot roll back or the scenario does not come to rest by
    its own master and step.
    """
    unable = [name for name, known in plan.interfaces.items() if not known.rollback]
    if unable:
        raise InputError(f"{plan.path}: {', '.join(unable)} cannot roll back: not linearised")
    size = step or plan.grid.step
    with System(endless(plan, size)) as system:
        master = master_class(plan.scenario.master.kind)(system, plan.scenario.master)
        stepper = Stepper(system, master)
        time, largest = rest(system, stepper)
        for _ in range(REFRESHED):
            stepper.to(time, time + size, size)
            time += size
        moment = system.save()
        shown = [k for k in system.wired.tolist() if system.variables[k].unit != "s"]
        models = [
            _model(system, moment, index, time, size, shown, largest, count)
            for index in range(len(system.instances))
        ]
        system.forget(moment)
        names = [system.names[k] for k in shown]
        followers = [coupled.instance.name for coupled in system.followers]
    return StepMap(plan, size, models, names, followers)


def _model(
    system: System, moment: Moment, index: int, time: float, size: float,
    shown: list[int], largest: Values, count: int,
) -> InstanceModel:  # fmt: skip
    """Identify one instance alone: its other inputs stay as they are at rest.

    Members of laws that were zero all the way to rest carry nothing and are not nudged.
    """
    coupled = system.instances[index]
    system.restore(moment)
    coupled.gather()
    still = coupled.buffer.copy()
    own = [k for k in shown if coupled.stretch.start <= k < coupled.stretch.stop]
    wired = range(len(coupled.inputs))
    clocks = [k for k in wired if system.variables[coupled.sources[k]].unit == "s"]
    ahead = np.array([coupled.sources[k] < coupled.stretch.start for k in clocks], dtype=float)
    free = [k for k in wired if k not in clocks]
    usual = np.maximum(np.abs(still[free]), largest[coupled.sources[free]])
    values = np.array([system.variables[coupled.sources[k]].order == 0 for k in free], dtype=bool)
    usual = np.where((usual == 0.0) & values, UNKNOWN, usual)
    if own and free:
        probe = _Probe(system, moment, coupled, still, clocks, ahead, free, own, usual)
        a, b, c, direct, after = _identified(probe, time, size, count)
    else:  # it takes no value of others, or gives none: it has no part in the map
        a, b, c = np.zeros((0, 0)), np.zeros((0, len(free))), np.zeros((len(own), 0))
        direct = after = np.zeros((len(own), len(free)))
    by = np.where(usual > 0.0, usual, 1.0)
    return InstanceModel(
        name=coupled.instance.name,
        inputs=[coupled.arriving[k].input.name for k in free],
        outputs=[system.names[k] for k in own],
        a=a,
        b=b / by,
        c=c,
        d=direct / by,
        e=after / by,
        wires=_wiring(system, coupled, free, shown),
        rows=np.array([shown.index(k) for k in own], dtype=np.intp),
    )


@dataclass(frozen=True)
class _Probe:
    """An instance at rest; its free inputs are nudged one by one, over a step, up and down."""

    system: System
    moment: Moment
    coupled: CoupledInstance
    still: Values
    clocks: list[int]
    ahead: Values
    free: list[int]
    own: list[int]
    usual: Values

    def responses(
        self, time: float, size: float, count: int, nudge: float
    ) -> tuple[Values, Values, Values]:
        """Markov parameters (count, outputs, inputs), D before a step, and E right after it.

        All are for nudges of the usual size of each input; an input whose usual size is zero is
        left at zero response.
        """
        coupled, values = self.coupled, self.system.values
        shape = (len(self.own), len(self.free))
        sequence = np.zeros((count, *shape))
        direct, after = np.zeros(shape), np.zeros(shape)
        for column, k in enumerate(self.free):
            if self.usual[column] == 0.0:
                continue
            for sign in (1.0, -1.0):
                self.system.restore(self.moment)
                for n in range(count):
                    coupled.buffer[:] = self.still
                    coupled.buffer[k] += sign * nudge * self.usual[column] if n == 0 else 0.0
                    if n == 0:
                        coupled.instance.send()
                        coupled.instance.receive()
                        direct[:, column] += sign * values[self.own]
                    coupled.buffer[self.clocks] += (n + self.ahead) * size
                    coupled.instance.send()
                    coupled.instance.step(time + n * size, size)
                    if n == 0:
                        coupled.instance.receive()
                        after[:, column] += sign * values[self.own]
                    coupled.buffer[:] = self.still
                    coupled.buffer[self.clocks] += (n + 1) * size
                    coupled.instance.send()
                    coupled.instance.receive()
                    sequence[n, :, column] += sign * values[self.own]
        scale = 2.0 * nudge
        return sequence / scale, direct / scale, after / scale - sequence[0] / scale


def _identified(
    probe: _Probe, time: float, size: float, count: int
) -> tuple[Values, Values, Values, Values, Values]:
    """A, B, C, D and E of an instance for nudges of the usual size of each input.

    Raises `InputError` for a foreign one whose outputs do not answer two sizes of nudge alike.
    """
    system, instance = probe.system, probe.coupled.instance
    sequence, direct, after = probe.responses(time, size, count, NUDGE)
    again, _, _ = probe.responses(time, size, count, 0.5 * NUDGE)
    sequence, smallest = _sound(sequence, again)
    if not (instance.interface.ours or sequence.any() or direct.any() or after.any()):
        raise InputError(
            f"{system.plan.path}: {instance.name}: its outputs do not answer small changes of its"
            " inputs alike: the stability of its coupling cannot be predicted"
        )
    return *realise(sequence, smallest), direct, after


def _sound(sequence: Values, again: Values) -> tuple[Values, float]:
    """Responses on which two sizes of nudge agree, and the share that is noise.

    Outputs on which they disagree, differences of nearly equal numbers, are set to zero.
    """
    size = np.abs(sequence).max(axis=(0, 2))
    size = np.where(size > 0.0, size, 1.0)
    noise = np.abs(sequence - again).max(axis=(0, 2)) / size
    sound = noise < DOUBTFUL
    kept = np.where(sound[None, :, None], sequence, 0.0)
    return kept, max(NOISE, 10.0 * float(noise[sound].max(initial=0.0)))


def _wiring(system: System, coupled: CoupledInstance, free: list[int], shown: list[int]) -> Values:
    """Gain from each shown output to each free input of an instance."""
    wires = np.zeros((len(free), len(shown)))
    gains = {
        (f"{c.source}.{c.output.name}"): c.gain
        for c in system.plan.connections
        if c.target == coupled.instance.name
    }
    for row, k in enumerate(free):
        source = int(coupled.sources[k])
        wires[row, shown.index(source)] = gains[system.names[source]]
    return wires


def limit(plan: Plan, kind: str, low: float, high: float, *, within: float = 1e-3) -> float:
    """Communication step [s] at which a master's map of a scenario turns unstable, by bisection.

    `low` has to be stable and `high` unstable; raises `InputError` where they are not.
    """
    ends = [step_map(plan, step).radius(kind) for step in (low, high)]
    if ends[0] > 1.0 + SLACK or ends[1] <= 1.0 + SLACK:
        raise InputError(
            f"no limit of {kind} between {low:g} and {high:g} s: spectral radius {ends[0]:.4f}"
            f" and {ends[1]:.4f}"
        )
    while high - low > within * low:
        middle = 0.5 * (low + high)
        if step_map(plan, middle).radius(kind) > 1.0 + SLACK:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)
