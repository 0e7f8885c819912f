"""`resilin plot`: a plot of one result or several over each other, or of a sweep."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from . import common
from .command_list import RESULTS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("plot", rich_help_panel=RESULTS)(plot)


def plot(
    results: Annotated[
        list[Path], typer.Argument(help="A result, whole or partial; several runs, or one sweep.")
    ],
    variables: common.Variables = None,
    cycles: Annotated[
        float | None, typer.Option(help="How many of the last cycles; 0 for all, 5 if not given.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Plot; RESULT.png if not given. Also .svg, .pdf.")
    ] = None,
) -> None:
    """Draw runs over each other, or a sweep.

    Runs are drawn panel by panel of the scenario, or the variables of --variable. A sweep becomes
    lines over one axis, heat maps over two.

    Example: resilin plot results/flapping-full-wings.nc --variable "linkage.*_energy"
    """
    from ..report.image import check_plot
    from ..results.plot import CYCLES, overlay
    from ..results.recorded import attributes_of, is_sweep, read_recorded

    with common.reported():
        if output is not None:
            check_plot(output)
        if len(results) == 1 and is_sweep(attributes_of(results[0])):
            from ..results.netcdf import opened_file
            from ..studies.sweep.dataset import over_axes
            from ..studies.sweep.plot import draw

            if cycles is not None:
                raise InputError(f"--cycles: {results[0]} is a sweep, which has no time")
            with opened_file(results[0]) as data:
                drawn = draw(over_axes(data), output or results[0].with_suffix(".png"), variables)
        else:
            runs = {name: read_recorded(path) for name, path in common.run_names(results).items()}
            target = output or results[0].with_name(f"{'-'.join(p.stem for p in results)}.png")
            drawn = overlay(runs, target, variables, CYCLES if cycles is None else cycles)
    typer.echo(f"plot: {drawn}")
