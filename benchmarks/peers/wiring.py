"""From a scenario to a case, by the plan that the orchestrator has checked."""

from __future__ import annotations

from pathlib import Path

from build_fmus import build
from orchestrator import load
from orchestrator.scenario.plan import Plan

from .case import Case, Component, Start, Watched, Wire

WIRINGS = {"values": "held", "ports": "curvature"}
"""Plain numbers of each port, or all of its members: the scenario's key `laws` for each."""

MOTIONS = ("displacement", "flap_angle")
POINTS = 20
"""Points per cycle at which runs are compared: every number of steps is a multiple."""

FLOWS = {"value": "velocity", "torque": "flap_rate"}
"""Flow that makes a power with the first member of a port that carries an effort."""


def plan_of(
    scenario: str,
    library: Path,
    wiring: str,
    per_cycle: int,
    cycles: float,
    kind: str = "gauss-seidel",
    every: int = 1,
) -> Plan:
    """The scenario with one wiring, step and master, recorded every so many steps."""
    return load(
        scenario,
        None,
        library,
        master={"laws": WIRINGS.get(wiring, "curvature"), "kind": kind},
        time={"step": {"per_cycle": per_cycle}, "stop": f"{cycles:g} cycles"},
        record={"every": every},
    )


def moving(plan: Plan) -> list[str]:
    """Recorded motion that errors are taken of: travel, and the flap angle where there is one."""
    names = [f"{component}.{v.name}" for component, v in plan.records]
    return [name for name in names if name.rpartition(".")[2] in MOTIONS]


def case_of(scenario: str, library: Path, wiring: str, per_cycle: int, cycles: float) -> Case:
    """A scenario's case. Raises `ValueError` where a step or a wire cannot be given to others."""
    if per_cycle % POINTS:
        raise ValueError(f"{per_cycle} steps per cycle: must be a multiple of {POINTS}")
    plan = plan_of(scenario, library, wiring, per_cycle, cycles)
    for wired in plan.connections:
        if wired.gain != 1.0 or wired.offset != 0.0:
            raise ValueError(f"{wired.target}.{wired.input.name}: wires with a gain are not passed")
    wires = [
        Wire(
            c.source, c.output.name, c.output.reference, c.target, c.input.name, c.input.reference
        )
        for c in plan.connections
    ]  # fmt: skip
    watched = []
    for name in moving(plan):
        component, _, variable = name.partition(".")
        reference = plan.interfaces[component].variables[variable].reference
        watched.append(Watched(component, variable, reference))
    return Case(
        scenario=scenario,
        library=str(library.resolve()),
        cycles=cycles,
        per_cycle=per_cycle,
        wiring=wiring,
        step=plan.grid.step,
        count=plan.grid.count,
        every=per_cycle // POINTS,
        components=[_component(plan, name) for name in plan.order],
        wires=wires,
        watched=watched,
        bonds=_bonds(plan),
    )


def _component(plan: Plan, name: str) -> Component:
    """Start values as the scenario sets them, held inputs among them.

    Choices that differ from the FMU's own start are built into a variant of the FMU: half of
    the tools cannot set an enumeration, some without an error.
    """
    known = plan.interfaces[name]
    path = known.path.resolve()
    values = {key: float(value) for key, value in plan.starts[name].items()}
    for key, value in plan.held.items():
        owner, _, variable = key.partition(".")
        if owner == name:
            values[variable] = value
    chosen = {}
    starts = []
    for key, value in values.items():
        given = known.variables[key]
        if given.kind == "Real":
            starts.append(Start(key, given.reference, value))
        elif given.start != value:
            chosen[key] = given.choices[given.codes.index(int(value))]
    if chosen:
        alias = "_".join([path.stem, *chosen.values()])
        native = "PythonFMU" not in known.tool
        into = path.parent.parent / ("peers-native" if native else "peers")
        path = build(path.stem, alias=alias, changes=chosen, into=into, native=native).path
    return Component(name, str(path.resolve()), starts)


def _bonds(plan: Plan) -> list[tuple[int, int]]:
    """Pairs of wires, there and back, whose values make a power: effort first, then flow."""
    wired = {(c.source, c.target, c.output.member): k for k, c in enumerate(plan.connections)}
    found = []
    for (source, target, member), place in wired.items():
        flow = FLOWS.get(member)
        if flow is not None and (target, source, flow) in wired:
            found.append((place, wired[target, source, flow]))
    return found
