"""`resilin plot`: a plot of a result file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import common


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("plot")(plot)


def plot(
    result: Annotated[Path, typer.Argument(help="A result, whole or partial.")],
    variables: Annotated[
        list[str] | None, typer.Option("--variable", help="Pattern, as linkage.*; may repeat.")
    ] = None,
    cycles: Annotated[float, typer.Option(help="How many of the last cycles; 0 for all.")] = 5.0,
    output: Annotated[
        Path | None, typer.Option(help="Plot; RESULT.png if not given. Also .svg, .pdf.")
    ] = None,
) -> None:
    """Draw a result over its last cycles: the scenario's panels, or the variables that match.

    Example: resilin plot results/flapping-full-wings.nc --variable "linkage.*_energy"
    """
    from ..results.plot import draw
    from ..results.recorded import read_recorded

    target = output or result.with_suffix(".png")
    with common.reported():
        drawn = draw(read_recorded(result), target, variables, cycles)
    typer.echo(f"plot: {drawn}")
