"""The drive of a scenario: the components that make a cycle of their own, by their parameters."""

from __future__ import annotations

from dataclasses import replace

from ...scenario.plan import Plan

SOURCE = ("amplitude", "frequency")
CONTROLLER = ("largest_voltage", "start_frequency")
"""Parameters of a component that drives: what switches it off where it is zero, and its cycle."""
STEADY = {"constant", "external"}
"""Waveforms whose value does not change by itself."""


def quiet(plan: Plan) -> Plan:
    """The same scenario with its drive off: `amplitude` zero where there is a `frequency` too.

    Recordings are zero throughout, as if the run began long after their last row.
    """
    starts = {name: dict(values) for name, values in plan.starts.items()}
    for name in _having(plan, SOURCE):
        starts[name]["amplitude"] = 0.0
    grid = plan.grid
    recordings = {
        name: replace(
            recording, track=track, after="zero", offset=2.0 * grid.start - grid.stop - track.end
        )
        for name, recording in plan.recordings.items()
        for track in [replace(recording.track, period=0.0, after="zero")]
    }
    return replace(plan, starts=starts, actions=[], faults=[], recordings=recordings)


def driving(plan: Plan) -> str:
    """What keeps a scenario from rest, as `amplifier.amplitude`; empty where nothing drives it.

    It is read from the start values: actions, and recordings that repeat, are not looked at.
    """
    for kind in (SOURCE, CONTROLLER):
        for name in _having(plan, kind):
            if all(_start(plan, name, parameter) for parameter in kind) and _changes(plan, name):
                return f"{name}.{kind[0]}"
    return ""


def _having(plan: Plan, parameters: tuple[str, ...]) -> list[str]:
    return [
        name
        for name, known in plan.interfaces.items()
        if {*parameters} <= {v.name for v in known.of("parameter")}
    ]


def _changes(plan: Plan, name: str) -> bool:
    """Whether the waveform of a component, where it has one to choose, changes by itself."""
    waveform = plan.interfaces[name].variables.get("waveform")
    if waveform is None or not waveform.choices:
        return True
    code = int(_start(plan, name, "waveform") or 0)
    return waveform.choices[waveform.codes.index(code)] not in STEADY


def _start(plan: Plan, name: str, parameter: str) -> float | str | None:
    return plan.starts[name].get(parameter, plan.interfaces[name].variables[parameter].start)
