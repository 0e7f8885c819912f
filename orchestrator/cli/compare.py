"""`resilin compare`: two results side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import common, completion
from .command_list import RESULTS
from .result_kinds import runs_or_sweeps

if TYPE_CHECKING:
    import xarray
    from rich.table import Table

    from ..results.recorded import Recorded


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("compare", rich_help_panel=RESULTS)(compare)


def compare(
    one: Annotated[
        Path,
        typer.Argument(
            help="A result by name or path; runs are compared at its times.",
            autocompletion=completion.results,
        ),
    ],
    other: Annotated[
        Path,
        typer.Argument(help="The result to compare with it.", autocompletion=completion.results),
    ],
    variables: common.Variables = None,
    output: Annotated[
        Path | None, typer.Option(help="Plot of both over each other, as .png, .svg or .pdf.")
    ] = None,
    json: common.Json = False,
) -> None:
    """Compare two runs, or two sweeps.

    It shows the settings that differ. Of runs it then shows the metrics of both and how far each
    variable differs; of sweeps how far each metric differs, at the points that both have.

    \b
    Example: resilin compare flapping-full-wings slower
    """
    from ..report.image import check_plot

    with common.reported():
        if output is not None:
            check_plot(output)
        pair = [common.result_file(each) for each in (one, other)]
        names = common.run_names(pair)
        runs, sweeps = runs_or_sweeps(pair)
        shown, facts, missing = (
            _of_sweeps(sweeps, variables, output) if sweeps else _of_runs(runs, variables, output)
        )
    if json:
        common.print_json(
            {
                "results": list(map(str, names.values())),
                **facts,
                "missing": dict(zip(names, missing, strict=True)),
            }
        )
        return
    console = common.console()
    for each in shown:
        console.print(each)
    for name, lacking in zip(names, missing, strict=True):
        if lacking:
            console.print(f"not in {name}: {', '.join(lacking)}")
    if output is not None:
        typer.echo(f"plot: {output}")


Shown = tuple[Sequence["Table | str"], dict[str, Any], tuple[list[str], list[str]]]
"""Tables and lines, facts for scripts, and what each of the two lacks."""


def _of_runs(runs: dict[str, Recorded], variables: list[str] | None, output: Path | None) -> Shown:
    from ..results.comparison import compared
    from ..results.plot import overlay
    from .compared_runs import facts, remarks, settings_table, tables

    found = compared(*runs.values(), patterns=variables)
    if output is not None:
        overlay(runs, output, variables)
    names = list(runs)
    shown = [*remarks(runs), *settings_table(found.settings, names), *tables(found, names)]
    told = {"notes": {name: asdict(run.notes) for name, run in runs.items()}, **facts(found)}
    return shown, told, found.missing


def _of_sweeps(
    sweeps: dict[str, xarray.Dataset], variables: list[str] | None, output: Path | None
) -> Shown:
    from ..results.comparison import differing
    from ..results.scenario_attribute import settings
    from ..studies.sweep.comparison import compared
    from ..studies.sweep.plot import overlay
    from .compared_runs import settings_table
    from .compared_sweeps import facts, remarks, table

    found = compared(*sweeps.values(), patterns=variables)
    one, other = (
        {k: v for k, v in settings(data.attrs).items() if k not in found.axes}
        for data in sweeps.values()
    )
    apart = differing(one, other)
    if output is not None:
        overlay(sweeps, output, variables)
    names = list(sweeps)
    shown = [*settings_table(apart, names), table(found, names), *remarks(found, names)]
    return shown, {"settings": apart, **facts(found)}, found.missing
