"""`resilin record`: the outputs of a part, as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import common
from .command_list import RUNS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("record", rich_help_panel=RUNS)(record)


def record(
    scenario: common.ScenarioName,
    part: Annotated[str, typer.Option(help="Component of the scenario.")],
    output: Annotated[
        Path | None,
        typer.Option(help="Recording, .csv or .nc; results/SCENARIO-PART.csv if not given."),
    ] = None,
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    stop: common.Stop = None,
    step: common.Step = None,
    tolerance: common.Tolerance = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    quiet: common.Quiet = False,
) -> None:
    """Run a scenario; record the outputs of one part.

    The recording can take the place of the part.

    \b
    Example: resilin record flapping-full-wings --part amplifier --stop "10 cycles"
    """
    from ..report.files import check_place
    from ..results.port_recording import left_out, with_recorded_ports, write_port_recording
    from ..simulation.interrupt import Interrupt
    from ..simulation.load import load, unloaded
    from ..simulation.run import run

    with Interrupt() as interrupt, common.reported():
        target = output or Path("results") / f"{Path(scenario).stem}-{part}.csv"
        check_place(target, "recordings are written as .csv or .nc", [".csv", ".nc"])
        options = common.overrides(laws, kind, stop, step, tolerance)
        changes, parts = common.assignments(set_), common.library(fmus, native, scenario)
        with_recorded_ports(unloaded(scenario, changes, parts, **options), part)
        plan = with_recorded_ports(load(scenario, changes, parts, **options), part)
        outcome = run(plan, interrupt=interrupt, estimate=False)
        written = write_port_recording(outcome, target)
        if not quiet:
            typer.echo(f"{outcome.kept} rows of {len(outcome.names)} variables: {written}")
            omitted = left_out(plan, part)
            if omitted:
                typer.echo(f"left out, as a recording holds numbers only: {', '.join(omitted)}")
        if outcome.failure is not None:
            raise outcome.failure
