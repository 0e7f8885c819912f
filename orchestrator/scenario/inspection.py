"""What a checked scenario is made of, as tables: components, connections, held inputs, time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import printable
from ..fmi.description import Variable
from ..report.notebook import Card, of_terminal
from ..report.whole_names import keep_whole
from .connections import Connection
from .execution_order import reachable
from .metric_expression import LONGEST, expression_of, not_recorded
from .part_inspection import LAWS
from .plan import Plan
from .processes import MASTERS, process_of
from .schema import AUTO

if TYPE_CHECKING:
    from rich.table import Table


def tables(plan: Plan) -> list[Table]:
    """Components in execution order, their start values, wires by port, held inputs, master.

    Then loops and recordings, the time grid, and the metrics with their definitions.
    """
    return [
        keep_whole(_components(plan), 0, 1),
        keep_whole(_starts(plan), 0, 1),
        keep_whole(_wires(plan), 0, 1),
        keep_whole(_held(plan), 0),
        keep_whole(_master(plan), 0),
        keep_whole(_shape(plan)),
        keep_whole(_time(plan)),
        *([keep_whole(_metrics(plan), 0)] if plan.scenario.metrics.defined else []),
    ]


def card(plan: Plan) -> Card:
    """The same for a notebook, all but the components folded away."""
    first, *more = (of_terminal(table) for table in tables(plan))
    master = plan.scenario.master
    lines = [
        f"{plan.path}",
        f"{_steps(plan)} by {master.kind}, laws: {master.laws}",
    ]
    if plan.step_reason:
        lines.append(f"auto: {plan.step_reason}")
    return Card(printable(plan.scenario.title) or plan.path.stem, lines, [first], more)


def facts(plan: Plan) -> dict[str, Any]:
    """The same as data for scripts."""
    return {
        "title": plan.scenario.title,
        "master": plan.scenario.master.model_dump(),
        "order": plan.order,
        "units": {
            name: {
                "fmu": str(known.path),
                "guid": known.guid,
                "fmi": known.version,
                "isolated": process_of(plan, name) != MASTERS,
                "rollback": known.rollback,
                "variable_step": known.variable_step,
                "ports": known.ports(),
                "start": plan.starts[name],
            }
            for name, known in plan.interfaces.items()
        },
        "wires": [
            {
                "from": f"{c.source}.{c.output.name}",
                "to": f"{c.target}.{c.input.name}",
                "gain": c.gain,
                "offset": c.offset,
                "order": c.input.order,
            }
            for c in plan.connections
        ],
        "held": plan.held,
        "loops": loops(plan),
        "left_out": plan.scenario.without,
        "recordings": {
            name: {"begin": r.begin, "end": r.end, "outputs": list(r.interface.variables)}
            for name, r in plan.recordings.items()
        },
        "dropped": plan.dropped,
        "metrics": plan.scenario.metrics.defined,
        "records": plan.record_names + plan.text_names,
        "time": {
            "start": plan.grid.start,
            "stop": plan.grid.stop,
            "step": AUTO if _is_open(plan) else plan.grid.step,
            "steps": None if _is_open(plan) else plan.grid.count,
            "frequency": plan.frequency,
        },
    }


def _is_open(plan: Plan) -> bool:
    """Whether trials have still to find the step, which need the FMUs loaded."""
    return plan.scenario.time.step == AUTO


def _steps(plan: Plan) -> str:
    if _is_open(plan):
        return "steps that a run chooses"
    return f"{plan.grid.count} steps of {plan.grid.step:.4g} s"


def loops(plan: Plan) -> list[list[str]]:
    """Components that feed each other, loop by loop, in execution order."""
    reach = reachable(plan.order, [(c.source, c.target) for c in plan.connections])
    found = []
    for name in plan.order:
        ring = [n for n in plan.order if n in reach[name] and name in reach[n]]
        if ring and ring not in found:
            found.append(ring)
    return found


def _components(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("component", "FMU", "rollback", "ports", title="components")
    for name in plan.order:
        interface = plan.interfaces[name]
        table.add_row(
            name,
            printable(interface.path.name),
            "yes" if interface.rollback else "no",
            ", ".join(map(printable, interface.ports())),
        )
    return table


def _starts(plan: Plan) -> Table:
    """What the scenario sets, by the names that `--set` takes."""
    from rich.table import Table

    table = Table("start value", "value", title="start values that the scenario sets")
    for name in plan.order:
        known = plan.interfaces[name].variables
        for key, value in plan.starts[name].items():
            table.add_row(printable(f"{name}.{key}"), printable(_shown(known[key], value)))
    return table


def _shown(variable: Variable, value: float | str) -> str:
    """A start value with its unit, or the name of the choice."""
    if variable.choices:
        return variable.choices[variable.codes.index(int(float(value)))]
    if isinstance(value, str):
        return value
    unit = "" if variable.unit == "1" else f" {variable.unit}"
    return f"{value:.6g}{unit}"


def _wires(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("from", "to", "values", "affine", "curvature", title="connected members")
    groups: dict[tuple[str, str], list[Connection]] = {}
    for c in plan.connections:
        ends = (
            f"{c.source}.{c.output.port or c.output.name}",
            f"{c.target}.{c.input.port or c.input.name}",
        )
        groups.setdefault(ends, []).append(c)
    for (source, target), members in groups.items():
        counts = [sum(c.input.order == order for c in members) for order in range(len(LAWS))]
        table.add_row(source, target, *(str(count) for count in counts))
    return table


def _held(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("held input", "value", "unit", title="held")
    for key, value in plan.held.items():
        component, _, name = key.partition(".")
        table.add_row(key, f"{value:g}", plan.interfaces[component].variables[name].unit)
    return table


def _master(plan: Plan) -> Table:
    """The method that steps the components, which follows from the wires where none is named."""
    from rich.table import Table

    master = plan.scenario.master
    table = Table("master", "laws", "order", title="master")
    table.add_row(master.kind, master.laws, ", ".join(plan.order))
    return table


def _shape(plan: Plan) -> Table:
    """Loops, recordings, and what the scenario leaves out or drops."""
    from rich.table import Table

    table = Table("", "components", title="structure")
    for ring in loops(plan):
        table.add_row("loop", ", ".join(ring))
    table.add_row("left out", ", ".join(map(printable, plan.scenario.without)) or "nothing")
    for name, recording in plan.recordings.items():
        span = f"{recording.begin:g} to {recording.end:g} s"
        table.add_row(
            "recording", f"{name}: {span}, {plan.scenario.components[name].interpolation}"
        )
    for line in plan.dropped:
        table.add_row("dropped", printable(line))
    return table


def _time(plan: Plan) -> Table:
    from rich.table import Table

    grid = plan.grid
    table = Table("start", "stop", "step", "steps", "frequency", "recorded", title="time")
    frequency = f"{plan.frequency:g} Hz" if plan.frequency else "none"
    texts = f" and {len(plan.texts)} texts" if plan.texts else ""
    table.add_row(
        f"{grid.start:g} s", f"{grid.stop:g} s",
        "auto" if _is_open(plan) else f"{grid.step:.6g} s",
        "a run chooses" if _is_open(plan) else str(grid.count),
        frequency, f"{len(plan.records)} variables{texts}",
    )  # fmt: skip
    return table


def _metrics(plan: Plan) -> Table:
    from rich.table import Table

    table = Table("metric", "definition", title="metrics")
    for name, text in plan.scenario.metrics.defined.items():
        reason = not_recorded(expression_of(text), plan.record_names)
        left_out = f"; left out: {reason}" if reason else ""
        table.add_row(printable(name), printable(text, most=LONGEST) + left_out)
    return table
