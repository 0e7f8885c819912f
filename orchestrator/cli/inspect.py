"""`resilin inspect`, `resilin scenarios`: what a scenario is made of; which ones there are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import renamed
from . import common, parts
from .command_list import SCENARIOS
from .renamed_options import known_as

if TYPE_CHECKING:
    from ..scenario.plan import Plan


def add_to(app: typer.Typer) -> None:
    """Register the commands."""
    app.command("inspect", rich_help_panel=SCENARIOS, cls=known_as(diagram="output"))(inspect)
    app.command("scenarios", rich_help_panel=SCENARIOS)(scenarios)
    app.command("scenes", hidden=True)(_scenes)


def inspect(
    scenario: common.ScenarioName,
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    output: Annotated[
        Path | None, typer.Option(help="Drawing of components and wires, as .svg or .png.")
    ] = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    stability: Annotated[
        bool,
        typer.Option("--stability", help="Load the FMUs; warn of a coupling unstable at its step."),
    ] = False,
    json: common.Json = False,
) -> None:
    """Check a scenario and show what it is made of.

    No FMU is loaded, except for --stability. An .fmu file, or a part that is no scenario, is
    shown as by `resilin parts`.

    \b
    Example: resilin inspect flapping-full-wings --output vehicle.svg
    """
    from ..report.files import check_place
    from ..scenario.files import scenario_names
    from ..scenario.library import part_names
    from ..simulation.load import load, unloaded

    with common.reported():
        library = common.library(fmus, native, scenario)
        if scenario.endswith(".fmu") or scenario in {*part_names(library)} - {*scenario_names()}:
            parts.show(scenario, library, json)
            return
        if output is not None:
            check_place(output, "a diagram is an SVG or a PNG", [".svg", ".png"])
        options = common.overrides(laws, kind)
        read = load if stability else unloaded
        plan = read(scenario, common.assignments(set_), library, **options)
        if output is not None:
            from ..scenario.diagram.draw import draw

            draw(plan, output)
        verdict = _stability(plan) if stability else ""
    if json:
        from ..scenario.inspection import facts

        common.print_json(facts(plan))
        return
    from ..scenario.inspection import tables

    for table in tables(plan):
        common.console().print(table)
    if verdict:
        typer.echo(verdict)
    if output is not None:
        typer.echo(f"diagram: {output}")


def _stability(plan: Plan) -> str:
    """Prediction of the linear step map for the scenario's master and step, with the wire."""
    from ..simulation.linear.drive import quiet
    from ..simulation.linear.step_map import MAPPED, SLACK, step_map

    kind = plan.scenario.master.kind
    if kind not in MAPPED:
        return f"no prediction for {kind}: its step has no linear map"
    mapped = step_map(quiet(plan))
    radius = mapped.radius(kind)
    if radius <= 1.0 + SLACK:
        at = f"{kind} at {plan.grid.step:.4g} s, drive off,"
        return f"{at} is stable: spectral radius {radius:.4f}"
    return (
        f"warning: {mapped.culprit(kind)} is unstable with {kind} at {plan.grid.step:.4g} s:"
        f" it grows by {radius:.4f} each step; lower the step, connect whole ports, or use"
        " another master"
    )


def _scenes() -> None:
    """The name of `scenarios` in earlier releases."""
    renamed("the command scenes", "scenarios")
    scenarios()


def scenarios(json: common.Json = False) -> None:
    """List the scenarios that come with the package.

    \b
    Example: resilin scenarios
    """
    from ..scenario.files import scenario_names
    from ..scenario.parse import load_scenario

    found = [(name, *load_scenario(name)) for name in scenario_names()]
    if json:
        common.print_json(
            [
                {
                    "scenario": name,
                    "title": scenario.title,
                    "file": str(path),
                    "components": {
                        key: part.fmu or part.data for key, part in scenario.components.items()
                    },
                    "metrics": list(scenario.metrics.defined),
                }
                for name, scenario, path in found
            ]
        )
        return
    width = max(len(name) for name, *_ in found)
    for name, scenario, _ in found:
        typer.echo(f"{name:{width}} {scenario.title}")
