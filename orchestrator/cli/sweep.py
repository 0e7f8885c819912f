"""`resilin sweep`: a scenario over ranges of its start values."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from . import common, completion
from .command_list import RUNS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("sweep", rich_help_panel=RUNS)(sweep)


def sweep(
    scenario: common.ScenarioName,
    over: Annotated[
        list[str],
        typer.Option(
            help="Axis, as amplifier.frequency=1:50:2Hz, =1:50/26Hz or =2,4,6,8; may repeat.",
            autocompletion=completion.start_values,
        ),
    ],
    output: Annotated[
        Path | None, typer.Option(help="Result file; results/SCENARIO.sweep.nc if not given.")
    ] = None,
    name: common.Name = None,
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    stop: common.Stop = None,
    step: common.Step = None,
    tolerance: common.Tolerance = None,
    workers: common.Workers = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a running dask scheduler, as tcp://host:8786.")
    ] = None,
    patience: common.Patience = None,
    refine: Annotated[
        str | None, typer.Option(help='Metric whose peak gets more points, as "travel".')
    ] = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Run a scenario at every point of a grid of start values.

    Its metrics are kept over the axes. A point that fails does not affect the others. A sweep that
    was stopped goes on where it was when the same command is given again.

    \b
    Example: resilin sweep flapping-full-wings --over amplifier.frequency=10:26:1Hz
    """
    from ..simulation.interrupt import Interrupt
    from ..studies.sweep.study import sweep as run_sweep

    with Interrupt() as interrupt, common.reported():
        target = common.result_path(scenario, output, name, ".sweep.nc")
        data = run_sweep(
            scenario,
            over,
            common.library(fmus, native, scenario),
            target,
            changes=common.assignments(set_),
            options=common.overrides(laws, kind, stop, step, tolerance),
            workers=workers,
            scheduler=scheduler,
            patience=patience,
            refine=refine,
            overwrite=output is not None,
            progress=not (quiet or json) and sys.stderr.isatty(),
            interrupt=interrupt,
        )
    if json:
        from ..studies.sweep.table import facts

        common.print_json({"result": str(target), "points": facts(data)})
    elif not quiet:
        from rich.text import Text

        from ..studies.sweep.table import remarks, tables

        console = common.console()
        for table in tables(data, console.width):
            console.print(table)
        for line in remarks(data):
            console.print(Text(line))
        typer.echo(f"result: {target}")
    failed = int((data["status"] == "failed").sum())
    if failed:
        common.fail(
            f"{failed} of {data['status'].size} points failed; {target} holds the reasons", 1
        )
