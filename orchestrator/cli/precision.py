"""`resilin precision`: error against run time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common

if TYPE_CHECKING:
    from ..studies.precision.study import MeasuredRun


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("precision")(precision)


def precision(
    scenario: common.ScenarioName,
    method: Annotated[
        list[str] | None,
        typer.Option(help="Master, or master/laws as jacobi/held; may repeat. All if not given."),
    ] = None,
    factor: Annotated[
        list[float] | None,
        typer.Option(help="Steps as multiples of the scenario's; 8 to 1/8 if not given."),
    ] = None,
    tolerance: Annotated[
        list[float] | None,
        typer.Option(help="Let an error estimate choose the steps too, as 1e-3; may repeat."),
    ] = None,
    also: Annotated[
        list[str] | None,
        typer.Option(help="Another scenario at the same steps, against the same reference."),
    ] = None,
    reference: Annotated[
        str | None,
        typer.Option(help="monolith or self; if not given, the monolith where there is one."),
    ] = None,
    variable: Annotated[
        list[str] | None,
        typer.Option(help="Variable whose error counts; the leading ones if none."),
    ] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Runs whose least wall time counts.")] = 3,
    output: Annotated[
        Path | None, typer.Option(help="CSV; results/SCENARIO.precision.csv if not given.")
    ] = None,
    set_: common.Sets = None,
    stop: common.Stop = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = False,
    html: common.Html = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Run a scenario by every method at several steps: error, order and run time of each.

    Example: resilin precision flapping-full-wings --stop "10 cycles"
    """
    from ..errors import InputError
    from ..report.page import prepare as prepare_page
    from ..report.page import write as write_page
    from ..simulation.interrupt import Interrupt
    from ..studies.precision.page import page
    from ..studies.precision.study import LADDER
    from ..studies.precision.study import precision as study_precision
    from ..studies.precision.table import advice, draw, facts, table, write

    target = output or Path("results") / f"{Path(scenario).stem}.precision.csv"

    def tell(measured: MeasuredRun) -> None:
        if sys.stderr.isatty() and not (quiet or json):
            typer.echo(
                f"{measured.method}, step {measured.step:.4g} s: {measured.status[:60]}",
                err=True,
            )

    with Interrupt() as interrupt, common.reported():
        if reference not in (None, "monolith", "self"):
            raise InputError(f"--reference {reference!r}: choose monolith or self")
        if any(not f > 0.0 for f in factor or []):
            raise InputError("--factor: has to be above zero")
        if any(not 0.0 < t < 1.0 for t in tolerance or []):
            raise InputError("--tolerance: has to be between 0 and 1")
        target.parent.mkdir(parents=True, exist_ok=True)
        if html is not None:
            prepare_page(html)
        study = study_precision(
            scenario,
            common.library(fmus, native),
            methods=method,
            ladder=factor or LADDER,
            tolerances=tolerance or (),
            also=also or (),
            reference="self" if reference == "self" else "monolith" if reference else None,
            variables=variable,
            repeats=repeats,
            changes=common.assignments(set_),
            options=common.overrides(stop=stop),
            interrupt=interrupt,
            tell=tell,
        )
        write(study, target)
        drawn = draw(study, target.with_suffix(".svg"))
        if html is not None:
            write_page(page(study), html)
    if json:
        common.print_json({"reference": study.reference, "runs": facts(study)})
    elif not quiet:
        from rich.console import Console

        Console().print(table(study))
        typer.echo(f"errors of {', '.join(study.variables)} against {study.reference}")
        for line in advice(study):
            typer.echo(line)
        typer.echo(f"table:   {target}\nplot:    {drawn}")
        if html is not None:
            typer.echo(f"page:    {html}")
