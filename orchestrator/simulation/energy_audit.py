"""Energy audit: what each coupling creates or loses, and whether it feeds a growth.

An instance that steps with values of another from the last communication point does work with a
force that is not quite the other's force. Over a step the coupling creates the integral of that
difference times the receiver's velocity: energy that neither instance has given. Mechanical
couplings are watched, at the communication points; the electrical ones pass a charge that one
instance owns, and what their laws miss moves the voltage, not the energy. Instances whose outputs
follow their inputs directly are taken to have no state.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NoReturn

from ..errors import Divergence
from ..scenario.connections import Connection
from ..scenario.plan import Plan
from ..units import UnitError, is_power
from . import port_laws
from .coupled_instance import CoupledInstance
from .system import System

CHECKED = 4
SPANS = (8, 16, 32, 64, 128, 256, 512, 1024, 2048)
BRIEF = 60
BLATANT = 0.1
"""Share of the exchanged energy that has to be created over spans of less than `BRIEF` steps."""
GROWTH = math.log(100.0)
RISE = math.exp(0.75 * GROWTH)
"""Growth from the first to the last quarter of a span in which exchange grows by `GROWTH`."""
POWER = 9.0
"""A growth as this power of the time since the exchange began is a start from rest, not a fault."""
EVEN = 0.6
FED = 2e-3
FAINT = 1e-25
"""Exchanged energy [J] below which there is only rounding."""

Law = Callable[[port_laws.Members, port_laws.Members, float], float]

LAWS: dict[str, tuple[Law, str]] = {
    "value": (port_laws.force, "velocity"),
    "torque": (port_laws.torque, "flap_rate"),
}
"""Ports by their first member: the law, and the flow that makes a power of its value."""


@dataclass
class Coupling:
    """One direction of a power coupling: an effort that a receiver uses, and the receiver's flow.

    Without a law the effort was one number over the step, and Simpson's rule with the effort's
    parabola gives the work of the difference; with a law the difference grows from the law's
    reference as a power of time, and `share` of its end value is the mean. `created` is
    energy that the coupling has created (lost where negative) and `exchanged` the integral of
    the power's magnitude [J]; `age` counts the steps since there was any exchange.
    """

    name: str
    receiver: CoupledInstance
    inputs: dict[str, int]
    effort: int
    flow: int
    back: dict[str, int]
    law: Law | None
    scale: float
    share: float
    created: float = 0.0
    exchanged: float = 0.0
    age: int = 0
    history: list[tuple[float, float]] = field(default_factory=list)
    last: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    motion: dict[str, float] = field(default_factory=dict)

    def begin(self, system: System, time: float) -> None:
        """Note the state at which a run starts."""
        values = system.values
        effort = float(values[self.effort]) * self.scale
        self.last = (time, effort, float(values[self.flow]), effort)
        self.motion = {name: float(values[k]) for name, k in self.back.items()}

    def add(self, system: System, time: float) -> None:
        """Account for the step that ends here."""
        values = system.values
        then, effort, flow, earlier = self.last
        size = time - then
        now, moving = float(values[self.effort]) * self.scale, float(values[self.flow])
        used = self.receiver.inputs
        if self.law is None:
            sent = float(used[self.inputs["value"]])
            middle = 0.375 * now + 0.75 * effort - 0.125 * earlier
            work = (sent - effort) * flow + 4.0 * (sent - middle) * 0.5 * (flow + moving)
            work = (work + (sent - now) * moving) / 6.0
        else:
            members = {name: float(used[k]) for name, k in self.inputs.items()}
            motion = {name: float(values[k]) for name, k in self.back.items()}
            first = self.law(members, self.motion, then) - effort
            last = self.law(members, motion, time) - now
            work = self.share * (first * flow + last * moving)
            self.motion = motion
        self.created += work * size
        self.exchanged += 0.5 * size * (abs(effort * flow) + abs(now * moving))
        self.last = (time, now, moving, effort)

    @property
    def ratio(self) -> float:
        """Energy created by energy exchanged."""
        return self.created / self.exchanged if self.exchanged else 0.0


class Audit:
    """Watches all power couplings of a system; stops a run whose growth they feed."""

    def __init__(self, system: System) -> None:
        self.couplings = list(_found(system))
        self.count = 0

    def summary(self) -> dict[str, tuple[float, float]]:
        """Energy created and exchanged by each coupling so far [J]."""
        return {c.name: (c.created, c.exchanged) for c in self.couplings}

    def sample(self, system: System, step: int, time: float) -> None:
        if step == 0:
            for coupling in self.couplings:
                coupling.begin(system, time)
            return
        for coupling in self.couplings:
            coupling.add(system, time)
            coupling.age += coupling.exchanged > 0.0
            coupling.history.append((coupling.created, coupling.exchanged))
        self.count += 1
        if self.count % CHECKED == 0:
            for coupling in self.couplings:
                del coupling.history[: -SPANS[-1] - 1]
                if span := _fed(coupling.history, coupling.age):
                    self.stop(coupling, span, time)

    def stop(self, coupling: Coupling, span: int, time: float) -> NoReturn:
        """Raise `Divergence` for a coupling that has fed a growth over `span` steps."""
        raise Divergence(
            f"{coupling.name} creates energy: what it exchanges has grown steadily for"
            f" {span} steps, t = {time:.6g} s, and {coupling.created:.3g} J of it came"
            " from nowhere; lower the step, connect whole ports, or use interface-newton"
        )


def _fed(history: list[tuple[float, float]], age: int) -> int:
    """Steps over which exchange has grown a hundredfold, evenly, on created energy; else 0.

    Four quarters whose logarithms grow alike, and most of all that was ever exchanged in
    them, distinguish an exponential from a swing through zero; over brief spans a growth by more
    than the `POWER` of the steps since the exchange began (`age`) distinguishes it from a start
    from rest. A growth that the instances themselves feed (flutter, pull-in) is not counted.
    """
    for span in SPANS:
        if len(history) <= span:
            break
        quarter = span // 4
        first = history[-1 - span + quarter][1] - history[-1 - span][1]
        since = (age - 0.125 * span) / max(age - 0.875 * span, 1.0) if span < BRIEF else 1.0
        if history[-1][1] - history[-1 - quarter][1] < max(RISE, since**POWER) * first:
            continue
        marks = [history[-1 - span + k * quarter] for k in range(5)]
        parts = [b[1] - a[1] for a, b in pairwise(marks)]
        if min(parts) <= 0.0:
            continue
        growth = [math.log(b / a) for a, b in pairwise(parts)]
        created = marks[-1][0] - marks[0][0]
        exchanged = marks[-1][1] - marks[0][1]
        if (
            min(growth) >= EVEN * max(growth)
            and created >= (BLATANT if span < BRIEF else FED) * exchanged
            and exchanged >= max(FAINT, 0.5 * marks[-1][1])
        ):
            return span
    return 0


def _found(system: System) -> Iterator[Coupling]:
    """Couplings that are wired both ways and whose units of measure make a power."""
    plan = system.plan
    for c in plan.connections:
        if c.input.order or not c.input.real:
            continue
        port = [
            d
            for d in plan.connections
            if (d.source, d.target, d.input.port) == (c.source, c.target, c.input.port)
        ]
        whole = len(port) > 1 and bool(c.input.port)
        law, wanted = LAWS.get(c.input.member, (None, "")) if whole else (None, "")
        answer = _answer(plan, c, wanted)
        if answer is None or (whole and law is None):
            continue
        yield _coupling(system, c, port if whole else [c], answer, law)


def _coupling(
    system: System, c: Connection, used: list[Connection], answer: Connection, law: Law | None
) -> Coupling:
    """The coupling of a wire, the members used with it, and the wire back."""
    plan = system.plan
    place = {name: k for k, name in enumerate(system.names)}
    order = _arriving(plan, place, c.target)
    back = {
        d.output.member: place[f"{d.source}.{d.output.name}"]
        for d in plan.connections
        if (d.source, d.target) == (c.target, c.source) and d.output.port == answer.output.port
    }
    source = f"{c.source}.{c.output.port or c.output.name}"
    return Coupling(
        name=f"{source} -> {c.target}.{c.input.port or c.input.name}",
        receiver=next(m for m in system.instances if m.instance.name == c.target),
        inputs={d.input.member if law else "value": order.index(d) for d in used},
        effort=place[f"{c.source}.{c.output.name}"],
        flow=place[f"{answer.source}.{answer.output.name}"],
        back=back,
        law=law,
        scale=c.gain,
        share=1.0 / (max(d.input.order for d in used) + 2.0),
    )


def _arriving(plan: Plan, place: dict[str, int], target: str) -> list[Connection]:
    """Connections into an instance, in the order of its inputs."""
    arriving = [c for c in plan.connections if c.target == target]
    return sorted(arriving, key=lambda c: place[f"{c.source}.{c.output.name}"])


def _answer(plan: Plan, there: Connection, member: str) -> Connection | None:
    """The wire back whose value makes a power of the one there."""
    for c in plan.connections:
        if (c.source, c.target) != (there.target, there.source) or c.input.order:
            continue
        if member and c.output.member != member:
            continue
        if not (c.output.unit and there.input.unit):
            continue
        try:
            if is_power(f"{there.input.unit}.{c.output.unit}"):
                return c
        except UnitError:
            continue
    return None
