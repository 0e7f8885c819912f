"""`resilin plot`: a plot of one result or several over each other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from . import common, completion
from .command_list import RESULTS
from .result_kinds import runs_or_sweeps


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("plot", rich_help_panel=RESULTS)(plot)


def plot(
    results: Annotated[
        list[Path],
        typer.Argument(
            help="A result by name or path, whole or partial; several runs or sweeps.",
            autocompletion=completion.results,
        ),
    ],
    variables: common.Variables = None,
    cycles: Annotated[
        float | None, typer.Option(help="How many of the last cycles; 0 for all, 5 if not given.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Plot; RESULT.png if not given. Also .svg, .pdf.")
    ] = None,
) -> None:
    """Draw runs over each other, or sweeps.

    Runs are drawn panel by panel of the scenario, or the variables of --variable. Sweeps become
    lines over one axis. Over two axes a sweep becomes a heat map, two the heat map of their
    difference.

    \b
    Example: resilin plot flapping-full-wings --variable "linkage.*_energy"
    """
    from ..report.image import check_plot
    from ..results.plot import CYCLES, overlay

    with common.reported():
        if output is not None:
            check_plot(output)
        found = [common.result_file(each) for each in results]
        target = output or found[0].with_name(f"{'-'.join(p.stem for p in found)}.png")
        runs, sweeps = runs_or_sweeps(found)
        if sweeps:
            from ..studies.sweep.plot import overlay as overlay_sweeps

            if cycles is not None:
                raise InputError(f"--cycles: {found[0]} is a sweep, which has no time")
            drawn = overlay_sweeps(sweeps, target, variables)
        else:
            drawn = overlay(runs, target, variables, CYCLES if cycles is None else cycles)
    typer.echo(f"plot: {drawn}")
