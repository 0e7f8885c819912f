"""`resilin precision`: error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common
from .command_list import RUNS
from .study_files import StudyFiles

if TYPE_CHECKING:
    from ..studies.precision.study import MeasuredRun, Study


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("precision", rich_help_panel=RUNS)(precision)


def precision(
    scenario: common.ScenarioName,
    method: common.MethodTexts = None,
    factor: Annotated[
        list[float] | None,
        typer.Option(
            help="Step as a multiple of the scenario's; may repeat. 8 to 1/8 if not given."
        ),
    ] = None,
    tolerance: Annotated[
        list[float] | None,
        typer.Option(help="Let an error estimate choose the steps too, as 1e-3; may repeat."),
    ] = None,
    also: Annotated[
        list[str] | None,
        typer.Option(help="Another scenario at the same steps and reference; may repeat."),
    ] = None,
    reference: Annotated[
        str | None,
        typer.Option(help="monolith or self; if not given, the monolith where there is one."),
    ] = None,
    variables: common.Variables = None,
    use: Annotated[
        float | None,
        typer.Option(
            help="Write a scenario with the cheapest setting for this error, as 1e-3:"
            " SCENARIO-0.001.toml."
        ),
    ] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Runs whose least wall time counts.")] = 3,
    output: Annotated[
        Path | None, typer.Option(help="CSV; results/SCENARIO.precision.csv if not given.")
    ] = None,
    set_: common.Sets = None,
    stop: common.Stop = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    html: common.Html = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Compare methods and steps: error, order and run time.

    The error of the variables counts, by default that of the scenario's leading ones.

    \b
    Example: resilin precision flapping-full-wings --stop "10 cycles"
    """
    from ..errors import InputError
    from ..simulation.interrupt import Interrupt
    from ..studies.precision.chosen_setting import check_setting, setting_path, write_setting
    from ..studies.precision.page import page
    from ..studies.precision.study import FACTORS
    from ..studies.precision.study import precision as study_precision
    from ..studies.precision.table import draw, facts, write

    target = output or Path("results") / f"{Path(scenario).stem}.precision.csv"
    files = StudyFiles(target, html)
    shown = common.shows_progress(quiet, json)

    def tell(measured: MeasuredRun) -> None:
        if shown:
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
        if use is not None and not 0.0 < use < 1.0:
            raise InputError("--use: has to be between 0 and 1")
        parts = common.library(fmus, native, scenario)
        files.check()
        if use is not None:
            check_setting(setting_path(scenario, use))
        study = study_precision(
            scenario,
            parts,
            methods=method,
            factors=factor or FACTORS,
            tolerances=tolerance or (),
            also=also or (),
            reference="self" if reference == "self" else "monolith" if reference else None,
            variables=variables,
            repeats=repeats,
            changes=common.assignments(set_),
            options=common.overrides(stop=stop),
            interrupt=interrupt,
            tell=tell,
        )
        files.write(study, table=write, plot=draw, page=page)
        written = None
        if use is not None:
            changes = common.assignments(set_)
            written = write_setting(study, scenario, use, parts, changes=changes, stop=stop)
    if json:
        common.print_json({"reference": study.reference, "runs": facts(study)})
    elif not quiet:
        _report(study)
        files.report()
        if written is not None:
            typer.echo(f"{'scenario:':8} {written}")


def _report(study: Study) -> None:
    """Print the table of runs, the reference, and the cheapest settings."""
    from ..studies.precision.table import cheapest_settings, table

    common.console().print(table(study))
    typer.echo(f"errors of {', '.join(study.variables)} against {study.reference}")
    for line in cheapest_settings(study):
        typer.echo(line)
