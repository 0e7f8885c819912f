"""A system, its master and its observers as the structures of the compiled loop.

Every pointer goes to an array that Python owns and that is kept alive here: what the loop writes,
Python sees, and the other way round.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np

from ...fmi.instance import InProcessInstance, place
from ...fmi.instance.buffers import Block as TypedBlock
from ..coupled_instance import CoupledInstance
from ..energy_audit import (
    BLATANT,
    BRIEF,
    CHECKED,
    EVEN,
    FAINT,
    FED,
    GROWTH,
    POWER,
    RISE,
    Audit,
    Coupling,
)
from ..masters import Extrapolated, Jacobi, Master
from ..observers import Guard, Recorder
from ..port_laws import force, torque
from ..step_control import Control, coupling_columns
from ..stepper import Stepper
from ..switch_location import switch_columns
from ..system import System
from . import structures as c

TYPES = {
    "float64": 0, "float32": 1, "int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6,
    "uint32": 7, "int64": 8, "uint64": 9, "bool": 10,
}  # fmt: skip
WIDE = (8, 9)
FORCE_MEMBERS = (
    "value", "reference_time", "reference_displacement", "reference_velocity",
    "stiffness", "damping", "rate", "curvature",
)  # fmt: skip
TORQUE_MEMBERS = (
    "torque", "reference_rate", "quadratic_drag", "quadratic_drag_slope", "damping",
)  # fmt: skip
MOTION = ("displacement", "velocity", "flap_rate")


class Layout:
    """The structures of one run; `serve` is called for instances that Python serves."""

    def __init__(
        self,
        system: System,
        master: Master,
        stepper: Stepper,
        guard: Guard,
        recorder: Recorder,
        audit: Audit | None,
        points: Sequence[float] | None,
    ) -> None:
        self._kept: list[Any] = []
        self.errors: list[BaseException] = []
        self.instances = (c.Instance * len(system.instances))(
            *(self._instance(coupled) for coupled in system.instances)
        )
        self.system = self._system(system)
        self.master = self._master(master, len(system.values))
        self.guard = self._guard(guard)
        self.recorder = c.Recorder()
        self.point_recorder(recorder)
        couplings = audit.couplings if audit is not None else []
        self.couplings = (c.Coupling * max(1, len(couplings)))(
            *(self._coupling(coupling) for coupling in couplings)
        )
        self.audit = c.Audit(
            couplings=ctypes.addressof(self.couplings),
            count=len(couplings),
            checked=CHECKED,
            steps=0 if audit is None else audit.count,
            growth=GROWTH,
            rise=RISE,
            power=POWER,
            even=EVEN,
            fed=FED,
            blatant=BLATANT,
            faint=FAINT,
            brief=BRIEF,
        )
        self.run = self._run(system, stepper, points)

    def arguments(self, watched: c.Audit | c.Control) -> list[Any]:
        """What the loop's function takes: with the audit on fixed steps, else with the control."""
        parts = (self.system, self.master, self.guard, self.recorder, watched, self.run)
        return [ctypes.byref(part) for part in parts]

    def point_recorder(self, recorder: Recorder) -> None:
        """Give the loop the recorder's arrays of now, which have room for `capacity` rows."""
        times, rows, columns = recorder.arrays
        self.recorder.columns = self._address(columns)
        self.recorder.rows = rows.ctypes.data
        self.recorder.times = times.ctypes.data
        self.recorder.column_count = len(columns)
        self.recorder.every = recorder.every
        self.recorder.count = recorder.count
        self.recorder.capacity = recorder.room
        self.recorder.from_ = recorder.begin

    def _address(self, array: Any) -> int | None:
        """Address of an array that stays alive; null for an empty one."""
        self._kept.append(array)
        return int(array.ctypes.data) if len(array) else None

    def _longs(self, numbers: Any) -> int | None:
        return self._address(np.array(numbers, dtype=np.int64))

    def _structures(self, kind: Any, made: list[Any]) -> int | None:
        if not made:
            return None
        block = (kind * len(made))(*made)
        self._kept.append(block)
        return ctypes.addressof(block)

    def _system(self, system: System) -> c.System:
        place = {id(coupled): k for k, coupled in enumerate(system.instances)}
        followers = np.array([place[id(f)] for f in system.followers], dtype=np.int32)
        return c.System(
            values=system.values.ctypes.data,
            instances=ctypes.addressof(self.instances),
            followers=self._address(followers),
            events=self._longs(system.events),
            value_count=len(system.values),
            instance_count=len(system.instances),
            follower_count=len(followers),
            event_count=len(system.events),
        )

    def _instance(self, coupled: CoupledInstance) -> c.Instance:
        instance = coupled.instance
        wired = len(coupled.sources)
        made = c.Instance(
            inputs=self._address(coupled.buffer),
            sources=self._longs(coupled.sources),
            plain=self._longs(coupled.plain),
            arriving=self._address(np.zeros(max(1, wired))),
            wired=wired,
            plain_count=len(coupled.plain),
            first=coupled.stretch.start,
            past=coupled.stretch.stop,
            steps=instance.steps,
            rollbacks=instance.rollbacks,
            direct=coupled.direct,
        )
        moves = [c.Move(t.ctypes.data, s.ctypes.data, len(t)) for t, s in coupled.moves]
        made.moves, made.move_count = self._structures(c.Move, moves), len(moves)
        if coupled.scaling is not None:
            made.gain, made.offset = map(self._address, coupled.scaling)
        if isinstance(instance, InProcessInstance):
            self._bind(made, instance)
        else:
            made.serve = self._served(coupled)
        return made

    def _bind(self, made: c.Instance, instance: InProcessInstance) -> None:
        """The FMU's own functions and the blocks of variables that they are called with."""
        binding = instance.binding()
        made.version = instance.interface.version
        made.component, made.do_step = binding.component, binding.do_step
        made.faults = ctypes.addressof(binding.faults)
        made.saved = binding.saved
        made.now, made.kept = binding.now, -inf if binding.saved else inf
        made.place = binding.place or None
        made.get_state, made.set_state, made.free_state = binding.states
        if binding.flags:
            made.flags = (c.POINTER * 3)(*binding.flags[:3])
            made.reached = binding.flags[3]
        made.set = self._transfer(binding.set)
        made.get = (c.Transfer * 2)(self._transfer(binding.get[0]), self._transfer(binding.get[-1]))

    def _transfer(self, what: tuple[list[tuple[TypedBlock, int]], Any]) -> c.Transfer:
        blocks, buffer = what
        made = []
        for block, call in blocks:
            plain = len(blocks) == 1 and block.plain(block.staging.dtype, len(buffer))
            values = buffer if plain else block.staging
            references = np.array(list(block.begin), dtype=np.uint32)
            kind = TYPES[str(block.staging.dtype)]
            made.append(
                c.Block(
                    call=call,
                    references=self._address(references),
                    values=self._address(values),
                    places=None if plain else self._longs(block.places),
                    indices=None if plain else self._longs(block.buffer),
                    reference_count=len(references),
                    value_count=len(values),
                    used=len(block.buffer),
                    type=kind,
                    wide=kind in WIDE,
                )
            )
        self._kept.append(buffer)
        address = buffer.ctypes.data if len(buffer) else None
        return c.Transfer(self._structures(c.Block, made), len(made), address)

    def _served(self, coupled: CoupledInstance) -> Any:
        """A call for an instance that has no C functions: a recording, an isolated one."""
        instance, errors = coupled.instance, self.errors
        states: list[Any] = []

        def serve(what: int, time: float, size: float) -> int:
            try:
                if what == place.SEND:
                    instance.send()
                elif what == place.STEP:
                    instance.step(time, size)
                elif what == place.SAVE:
                    states.append(instance.save())
                elif what == place.RESTORE:
                    instance.restore(states[-1])
                elif what == place.FORGET:
                    instance.forget(states.pop())
                else:
                    instance.receive(0 if what == place.RECEIVE_FIRST else -1)
            except BaseException as error:
                errors.append(error)
                return 3
            return 0

        call = c.Serve(serve)
        self._kept.append(call)
        return call

    def _master(self, master: Master, count: int) -> c.Master:
        made = c.Master(kind=c.GAUSS_SEIDEL)
        if isinstance(master, Jacobi):
            made.kind = c.JACOBI
        if isinstance(master, Extrapolated):
            made.kind, made.degree = c.EXTRAPOLATED, master.degree
            made.past.most = master.degree + 1
            for k in range(master.degree + 1):
                made.past.values[k] = self._address(np.zeros(count))
            for name in ("mean", "last", "before"):
                setattr(made, name, self._address(np.zeros(count)))
            made.stepped = self._address(np.zeros(count, dtype=np.uint8))
        return made

    def _guard(self, guard: Guard) -> c.Guard:
        return c.Guard(
            high=self._address(guard.high),
            low=self._address(guard.low),
            wired=self._address(guard.wired.astype(np.uint8)),
            peak=self._address(guard.peak),
            previous=self._address(guard.previous),
            growing=self._address(guard.growing),
            every=guard.every,
            windows=guard.WINDOWS,
            count=guard.count,
        )

    def _coupling(self, coupling: Coupling) -> c.Coupling:
        law = {force: c.FORCE, torque: c.TORQUE}.get(coupling.law, c.NO_LAW)  # type: ignore[arg-type]
        names = TORQUE_MEMBERS if law == c.TORQUE else FORCE_MEMBERS
        members = [coupling.inputs.get(name, -1) for name in names]
        members += [-1] * (c.MEMBERS - len(members))
        inputs = coupling.receiver.inputs
        history = np.zeros(2 * c.HISTORY)
        known = coupling.history[-c.HISTORY :]
        history[: 2 * len(known)] = np.array(known).ravel()
        return c.Coupling(
            inputs=self._address(inputs),
            history=self._address(history),
            members=(c.LONG * c.MEMBERS)(*members),
            back=(c.LONG * c.MOTIONS)(*(coupling.back.get(name, -1) for name in MOTION)),
            effort=coupling.effort,
            flow=coupling.flow,
            age=coupling.age,
            kept=len(known),
            scale=coupling.scale,
            share=coupling.share,
            created=coupling.created,
            exchanged=coupling.exchanged,
            last=(c.DOUBLE * 4)(*coupling.last),
            motion=(c.DOUBLE * c.MOTIONS)(*(coupling.motion.get(name, 0.0) for name in MOTION)),
            law=law,
        )

    def control(self, system: System, master: Master, settings: Control, able: bool) -> c.Control:
        """Step control by doubling where all instances roll back, else by foresight."""
        columns, switches = coupling_columns(system), switch_columns(system)
        buffers = [np.zeros(len(coupled.buffer)) for coupled in system.instances]
        addresses = np.array([b.ctypes.data for b in buffers], dtype=np.uintp)
        self._kept.append(buffers)
        self.taken = np.empty(1024)
        self.taken[0] = system.plan.grid.start
        made = c.Control(
            columns=self._longs(columns),
            whole=self._address(np.zeros(len(columns))),
            error=self._address(np.zeros(len(columns))),
            scale=self._address(np.abs(system.values[columns])),
            kept_values=self._address(np.zeros(len(system.values))),
            switches=self._longs(switches),
            kept_inputs=self._address(addresses),
            input_counts=self._longs([len(b) for b in buffers]),
            kept_states=self._address(np.zeros(len(buffers), dtype=np.uintp)),
            taken=self.taken.ctypes.data,
            column_count=len(columns),
            switch_count=len(switches),
            taken_count=1,
            taken_capacity=len(self.taken),
            tolerance=settings.tolerance,
            span=settings.span,
            order=settings.order,
            most=settings.most,
            least=settings.least,
            before=1.0,
            first=0.1 * system.plan.grid.step,
            next=system.plan.grid.step if able else 0.1 * system.plan.grid.step,
            latest=inf,
            doubling=able,
        )
        made.seen.most = 3
        for k in range(3):
            made.seen.values[k] = self._address(np.zeros(max(1, len(columns))))
        if isinstance(master, Extrapolated):
            made.kept_past.most = master.degree + 1
            for k in range(master.degree + 1):
                made.kept_past.values[k] = self._address(np.zeros(len(system.values)))
        return made

    def more_points(self, control: c.Control) -> None:
        """Room for twice as many communication points."""
        self.taken = np.concatenate([self.taken, np.empty_like(self.taken)])
        control.taken, control.taken_capacity = self.taken.ctypes.data, len(self.taken)

    def _run(self, system: System, stepper: Stepper, points: Sequence[float] | None) -> c.Run:
        grid = system.plan.grid
        given = None if points is None else np.array(points, dtype=float)
        return c.Run(
            points=None if given is None else self._address(given),
            start=grid.start,
            stop=grid.stop,
            step=grid.step,
            margin=stepper.margin,
            next_action=stepper.next_action,
            time=grid.start if given is None else given[0],
            count=grid.count if given is None else len(given) - 1,
            steps=stepper.steps,
            whole=stepper.whole,
            quiet=stepper.quiet,
            patience=inf,
        )
