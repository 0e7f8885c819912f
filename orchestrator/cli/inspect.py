"""`resilin inspect`, `resilin scenarios`: what a scenario is made of; which ones there are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import renamed
from . import common, parts

if TYPE_CHECKING:
    from ..scenario.plan import Plan


def add_to(app: typer.Typer) -> None:
    """Register the commands."""
    app.command("inspect")(inspect)
    app.command("scenarios")(scenarios)
    app.command("scenes", hidden=True)(_scenes)


def inspect(
    scenario: common.ScenarioName,
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    fmus: common.Library = common.BUILT,
    diagram: Annotated[
        Path | None, typer.Option(help="Draw components and wires into an .svg or .png file.")
    ] = None,
    stability: Annotated[
        bool,
        typer.Option("--stability", help="Load the FMUs; warn of a coupling unstable at its step."),
    ] = False,
    json: common.Json = False,
) -> None:
    """Check a scenario and show what it is made of; no FMU is loaded, except for --stability.

    An .fmu file, or a part that is no scenario, is shown as by `resilin parts`.

    Example: resilin inspect flapping-full-wings --diagram vehicle.svg
    """
    from ..scenario.files import scenario_names
    from ..scenario.library import part_names
    from ..simulation.load import load, unloaded

    if scenario.endswith(".fmu") or scenario in {*part_names(fmus)} - {*scenario_names()}:
        with common.reported():
            parts.show(scenario, fmus, json)
        return
    with common.reported():
        options = common.overrides(laws, kind)
        read = load if stability else unloaded
        plan = read(scenario, common.assignments(set_), fmus, **options)
        if diagram is not None:
            from ..scenario.diagram.draw import draw

            draw(plan, diagram)
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
    if diagram is not None:
        typer.echo(f"diagram: {diagram}")


def _stability(plan: Plan) -> str:
    """Prediction of the linear step map for the scenario's master and step, with the wire."""
    from ..simulation.linear.step_map import MAPPED, SLACK, quiet, step_map

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
