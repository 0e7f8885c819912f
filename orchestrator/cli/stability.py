"""`resilin stability`: stiff and extreme cases by every master at several steps."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common
from .command_list import RUNS
from .study_files import StudyFiles

if TYPE_CHECKING:
    from ..studies.stability import Study


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("stability", rich_help_panel=RUNS)(stability)


def stability(
    scenario: Annotated[
        str | None, typer.Argument(help="A scenario, in place of the list of extreme cases.")
    ] = None,
    cases: Annotated[
        Path | None, typer.Option(help="TOML file of cases; the shipped one if not given.")
    ] = None,
    case: Annotated[
        list[str] | None, typer.Option(help="One case of the list, by name; may repeat.")
    ] = None,
    method: common.MethodTexts = None,
    workers: common.Workers = None,
    patience: common.Patience = None,
    output: Annotated[
        Path | None, typer.Option(help="CSV; results/stability.csv if not given.")
    ] = None,
    set_: common.Sets = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    html: common.Html = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Run extreme cases by every master; class each run.

    Each takes 4 to 1024 steps in a cycle. A run is accurate, bounded but inaccurate with a
    warning, stopped with an error, or silently wrong; a silently wrong one makes the exit code 1.

    \b
    Example: resilin stability --case water --method gauss-seidel
    """
    from ..errors import InputError
    from ..scenario.files import as_base, scenario_path
    from ..simulation.interrupt import Interrupt
    from ..studies.stability import PATIENCE, Case, load_cases
    from ..studies.stability import stability as study_stability
    from ..studies.stability.cases import shipped
    from ..studies.stability.chart import draw, write
    from ..studies.stability.page import page

    with Interrupt() as interrupt, common.reported():
        if scenario is not None and (cases or case):
            raise InputError("stability: takes a scenario or a list of cases, not both")
        if set_ and scenario is None:
            raise InputError("--set: needs a scenario; the cases of a list have their own")
        if scenario is not None:
            path = scenario_path(scenario)
            changes = common.assignments(set_)
            listed = [
                Case(name=path.stem, scenario={"extends": as_base(scenario)}, set=dict(changes))
            ]
            file = Path(path.stem).absolute()
        else:
            file = cases or shipped()
            listed = load_cases(file, case)
        target = output or Path("results") / f"{'stability' if scenario is None else file.stem}.csv"
        files = StudyFiles(target, html)
        files.check()
        shown = common.shows_progress(quiet, json)

        def tell(done: int, total: int) -> None:
            if shown:
                typer.echo(f"\r{done} of {total} ", nl=done == total, err=True)

        study = study_stability(
            listed,
            file,
            common.library(fmus, native, scenario or file),
            methods=common.methods(method),
            workers=workers,
            patience=PATIENCE if patience is None else patience,
            interrupt=interrupt,
            tell=tell,
        )
        files.write(study, table=write, plot=draw, page=page)
    if json:
        trials = [asdict(trial) for trial in study.trials]
        common.print_json(
            {"count": study.count(), "references": study.references, "trials": trials}
        )
    elif not quiet:
        _report(study)
        files.report()
    if study.count()["silent"]:
        raise typer.Exit(1)


def _report(study: Study) -> None:
    """Print the table, the meaning of its letters, and the counts."""
    from ..studies.stability import CLASSES
    from ..studies.stability.chart import legend, table

    common.console().print(table(study))
    typer.echo(legend())
    lines = {
        "all": study.count(),
        "the scenarios' own": study.count("usual"),
        "step = auto": study.count("auto"),
    }
    for label, found in lines.items():
        typer.echo(f"{label + ':':16} " + ", ".join(f"{found[k]} {k}" for k in CLASSES))
    typer.echo(f"{study.wall_time:.0f} s, at most {study.memory / 1e6:.0f} MB a worker")
