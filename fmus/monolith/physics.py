"""The vehicle as one ODE behind the interface of a part, solved by scipy to a tolerance.

Parameters and outputs are those of the parts it is composed of, under the parts' names:
`amplifier.frequency`, `linkage.displacement`. A scenario made of our parts becomes its own
reference by naming this part in place of them. Not held to the rules for native physics,
except for its equations: it exists to be independent of the coupling, not to be fast.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from operator import attrgetter
from typing import Any

from ..aero import physics as aero
from ..amplifier import physics as amplifier
from ..linkage import physics as linkage
from ..linkage.kinematics import Range, flap, usable_range
from ..membrane import physics as membrane
from ..payload import physics as payload
from ..ports import ActuatorInput
from ..quantity import Quantity, parameter, quantities
from ..spring import physics as spring
from . import equations

PARTS = {
    "amplifier": amplifier,
    "spring": spring,
    "membrane": membrane,
    "payload": payload,
    "linkage": linkage,
    "aero": aero,
}
STIFF = 1.0e-5
"""Electrode time constant [s] below which an implicit method is used."""


def _renamed(part: str, record: type[Any]) -> list[tuple[str, type, Any]]:
    """Fields of a part's record under the part's name, FMI names `part.name`."""
    found: list[tuple[str, type, Any]] = []
    for field in dataclasses.fields(record):
        quantity: Quantity = field.metadata["quantity"]
        name = f"{part}.{quantity.fmi_name(field.name)}"
        whole = dataclasses.replace(quantity, port="", order=0, depends=(), name=name)
        if field.default is dataclasses.MISSING:
            renamed: Any = dataclasses.field(metadata={"quantity": whole})
        else:
            renamed = dataclasses.field(default=field.default, metadata={"quantity": whole})
        found.append((f"{part}_{field.name}", float, renamed))
    return found


_OWN = [
    (
        "mechanism",
        float,
        parameter(2.0, "1", "Mechanism driven", "chosen", choices=("payload", "linkage")),
    ),
    (
        "elasticity",
        float,
        parameter(1.0, "1", "Actuator model", "chosen", choices=("spring", "membrane")),
    ),
    ("wings", float, parameter(2.0, "1", "Air load", "chosen", choices=("none", "aero"))),
    (
        "tolerance",
        float,
        parameter(
            1.0e-10, "1", "Relative tolerance of the solver", "chosen", least=1e-13, most=1e-2
        ),
    ),
]

Params: Any = dataclasses.make_dataclass(
    "Params",
    _OWN + [entry for name, module in PARTS.items() for entry in _renamed(name, module.Params)],
    frozen=True,
)
_COMMANDS = ("command_top", "command_bottom")
Input: Any = dataclasses.make_dataclass(
    "Input",
    [e for e in _renamed("amplifier", amplifier.Input) if e[0].endswith(_COMMANDS)],
    frozen=True,
)
Output: Any = dataclasses.make_dataclass(
    "Output",
    [entry for name, module in PARTS.items() for entry in _renamed(name, module.Output)],
    frozen=True,
)
_SEEN = [field.name for field in dataclasses.fields(aero.State)]
_TRAVEL = [field.name for field in dataclasses.fields(Range)]
State: Any = dataclasses.make_dataclass(
    "State",
    [(name, float) for name in (*equations.FIELDS, *_TRAVEL, *_SEEN)],
    frozen=True,
)


def _of(part: str, p: Any) -> Any:
    """A part's own `Params` out of the whole."""
    module: Any = PARTS[part]
    names = quantities(module.Params)
    return module.Params(**{name: getattr(p, f"{part}_{name}") for name in names})


def _composition(p: Any, x: Any) -> equations.Composition:
    linked = p.mechanism == 2.0
    return equations.Composition(
        **{name: _of(name, p) for name in PARTS},
        travel=Range(**{name: getattr(x, name) for name in _TRAVEL}),
        filmed=float(p.elasticity == 2.0),
        linked=float(linked),
        winged=float(linked and p.wings == 2.0),
    )


_ENTRIES = attrgetter(*equations.FIELDS)


def right_hand_side(
    c: equations.Composition, u: amplifier.Input, inside: float
) -> Callable[[float, Any], list[float]]:
    """dy/dt for a solver, over one smooth piece of the drive, of which `inside` is a time.

    A trial state outside the model gives NaN, on which the solver shortens its step.
    """

    def derivative(t: float, y: Any) -> list[float]:
        here = equations.Vector(*map(float, y))
        try:
            return list(_ENTRIES(equations.rates(c, u, inside, t, here)))
        except (ValueError, OverflowError):
            return [math.nan] * len(equations.FIELDS)

    return derivative


def _drive(u: Any) -> amplifier.Input:
    return amplifier.Input(
        command_top=u.amplifier_command_top, command_bottom=u.amplifier_command_bottom
    )


def initial(p: Any, u: Any, t: float) -> Any:
    """Uncharged electrodes, the mechanism where its own parameters start it."""
    values = dict.fromkeys((*equations.FIELDS, *_TRAVEL, *_SEEN), 0.0)
    values.update({"sample_time": t, "reversal_time": t})
    if p.mechanism == 1.0:
        own: Any = _of("payload", p)
    else:
        own = _of("linkage", p)
        start = linkage.initial(own, linkage.Input(), t)
        values.update(dataclasses.asdict(usable_range(linkage.geometry(own))))
        values["displacement"] = start.displacement
    values["displacement"] = own.start_displacement
    values["velocity"] = own.start_velocity
    return State(**values)


def advance(p: Any, x: Any, u: Any, t: float, h: float) -> Any:
    """Solve over [t, t + h], restarting at every edge of the drive."""
    from scipy.integrate import solve_ivp

    c = _composition(p, x)
    drive = _drive(u)
    y = [getattr(x, name) for name in equations.FIELDS]
    lag = c.amplifier.resistance * (1e-9 if c.filmed == 1.0 else c.spring.capacitance)
    stiff = lag < STIFF or c.amplifier.bandwidth < 1.0e29
    begin = t
    stop = t + h
    while begin < stop:
        end = min(stop, amplifier.next_event(c.amplifier, begin))
        solved = solve_ivp(
            right_hand_side(c, drive, 0.5 * (begin + end)),
            (begin, end),
            y,
            method="Radau" if stiff else "DOP853",
            rtol=p.tolerance,
            atol=[p.tolerance * scale for scale in equations.SCALES],
        )
        if not solved.success:
            raise ValueError(f"the reference solver gave up: {solved.message}")
        y = [float(value) for value in solved.y[:, -1]]
        begin = end
    values = {name: getattr(x, name) for name in (*_TRAVEL, *_SEEN)}
    values.update(zip(equations.FIELDS, y, strict=True))
    after = State(**values)
    if c.winged != 1.0:
        return after
    parts = _observed(p, after, u, stop)
    seen = aero.seen(c.aero, _seen(x), _wing(parts["linkage"], stop), stop)
    return dataclasses.replace(after, **dataclasses.asdict(seen))


def _seen(x: Any) -> aero.State:
    return aero.State(**{name: getattr(x, name) for name in _SEEN})


def _wing(moving: linkage.Output, t: float) -> aero.Input:
    return aero.Input(
        motion_flap_angle=moving.flap_angle,
        motion_flap_rate=moving.flap_rate,
        motion_reference_time=t,
    )


def _observed(p: Any, x: Any, u: Any, t: float) -> dict[str, Any]:
    """Output of every part that is there, from the one state."""
    c = _composition(p, x)
    y = equations.Vector(*_ENTRIES(x))
    top, bottom = equations.voltages(c, y)
    rates = right_hand_side(c, _drive(u), t)(t, _ENTRIES(y))
    channels = dict.fromkeys((field.name for field in dataclasses.fields(amplifier.State)), 0.0) | {
        f"{side}_{name}": value
        for side, voltage, current in (("top", top, rates[2]), ("bottom", bottom, rates[3]))
        for name, value in (
            ("drive", getattr(x, f"{side}_drive")),
            ("charge", getattr(x, f"{side}_charge")),
            ("voltage", voltage),
            ("voltage_rate", 0.0),
            ("square_curvature", 0.0),
            ("current", current),
            ("peak_current", math.fabs(current)),
            ("supplied", getattr(x, f"{side}_supplied")),
            ("loss", getattr(x, f"{side}_loss")),
        )
    }
    found: dict[str, Any] = {
        "amplifier": amplifier.observe(
            c.amplifier, amplifier.State(**channels), amplifier.Input(), t
        ),
        **_actuator(c, x, top, bottom, t),
    }
    if c.linked != 1.0:
        at_rest = payload.State(
            displacement=x.displacement, velocity=x.velocity, force_work=x.force_work
        )
        found["payload"] = payload.observe(c.payload, at_rest, payload.Input(), t)
    else:
        angle, slope, bend = flap(linkage.geometry(c.linkage), c.travel, x.displacement)
        moving = linkage.State(
            displacement=x.displacement,
            velocity=x.velocity,
            angle=angle,
            slope=slope,
            bend=bend,
            force_work=x.force_work,
            viscous_loss=x.viscous_loss,
            friction_loss=x.friction_loss,
            stop_loss=x.stop_loss,
            load_work=x.load_work,
            **dataclasses.asdict(c.travel),
        )
        found["linkage"] = linkage.observe(c.linkage, moving, linkage.Input(), t)
    if c.winged == 1.0:
        found["aero"] = aero.observe(c.aero, _seen(x), _wing(found["linkage"], t), t)
    return found


def _actuator(
    c: equations.Composition, x: Any, top: float, bottom: float, t: float
) -> dict[str, Any]:
    """Output of the actuator that is there."""
    u = ActuatorInput(
        top_voltage=top,
        bottom_voltage=bottom,
        motion_displacement=x.displacement,
        motion_velocity=x.velocity,
        motion_reference_time=t,
    )
    if c.filmed != 1.0:
        held = spring.State(
            dissipated_energy=x.spring_loss,
            sample_time=t,
            sample_displacement=x.displacement,
            sample_velocity=x.velocity,
        )
        return {"spring": spring.observe(c.spring, held, u, t)}
    relaxed = dataclasses.replace(
        membrane.initial(c.membrane, u, t), u0=x.u0, u1=x.u1, u2=x.u2, u3=x.u3,
        viscous_loss=x.spring_loss,
    )  # fmt: skip
    return {"membrane": membrane.observe(c.membrane, relaxed, u, t)}


def observe(p: Any, x: Any, u: Any, t: float) -> Any:
    """Outputs of all parts; those of parts left out are zero."""
    found = _observed(p, x, u, t)
    values: dict[str, float] = {}
    for part, module in PARTS.items():
        names = quantities(module.Output)
        for name in names:
            values[f"{part}_{name}"] = getattr(found[part], name) if part in found else 0.0
    return Output(**values)
