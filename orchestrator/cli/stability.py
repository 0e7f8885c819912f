"""`resilin stability`: stiff and extreme cases by every master at several steps."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common

if TYPE_CHECKING:
    from ..studies.stability import Study


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("stability")(stability)


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
    method: Annotated[
        list[str] | None,
        typer.Option(help="Master, or master/laws as jacobi/held; may repeat. All if not given."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes; as many as processors if not given.")
    ] = None,
    patience: Annotated[float, typer.Option(help="Seconds that one run may take.")] = 30.0,
    output: Annotated[
        Path | None, typer.Option(help="CSV; results/stability.csv if not given.")
    ] = None,
    set_: common.Sets = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = False,
    html: common.Html = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Run extreme cases by every master at 4 to 1024 steps in a cycle; class each run.

    A run is accurate, bounded but inaccurate with a warning, stopped with an error, or silently
    wrong; a silently wrong one makes the exit code 1.

    Example: resilin stability --case water --method gauss-seidel
    """
    from ..errors import InputError
    from ..report.page import prepare as prepare_page
    from ..report.page import write as write_page
    from ..scenario.files import scenario_names, scenario_path
    from ..simulation.interrupt import Interrupt
    from ..studies.precision.method import parse_method
    from ..studies.stability import Case, load_cases
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
            name = scenario if scenario in scenario_names() else str(path.absolute())
            changes = common.assignments(set_)
            listed = [Case(name=path.stem, scenario={"extends": name}, set=dict(changes))]
            file = Path(f"{path.stem}.toml").absolute()
        else:
            file = cases or shipped()
            listed = load_cases(file, case)
        target = output or Path("results") / f"{'stability' if scenario is None else file.stem}.csv"
        target.parent.mkdir(parents=True, exist_ok=True)
        if html is not None:
            prepare_page(html)
        shown = sys.stderr.isatty() and not (quiet or json)

        def tell(done: int, total: int) -> None:
            if shown:
                typer.echo(f"\r{done} of {total} ", nl=done == total, err=True)

        study = study_stability(
            listed,
            file,
            common.library(fmus, native),
            methods=[parse_method(text) for text in method or []] or None,
            workers=workers,
            patience=patience,
            interrupt=interrupt,
            tell=tell,
        )
        write(study, target)
        drawn = draw(study, target.with_suffix(".svg"))
        if html is not None:
            write_page(page(study), html)
    if json:
        trials = [asdict(trial) for trial in study.trials]
        found = {"count": study.count(), "references": study.references, "trials": trials}
        common.print_json(found)
    elif not quiet:
        _report(study, {"table": target, "plot": drawn, "page": html})
    if study.count()["silent"]:
        raise typer.Exit(1)


def _report(study: Study, files: dict[str, Path | None]) -> None:
    """Print the table, the meaning of its letters, the counts, and where the files are."""
    from rich.console import Console

    from ..studies.stability import CLASSES
    from ..studies.stability.chart import legend, table

    Console().print(table(study))
    typer.echo(legend())
    lines = {
        "all": study.count(),
        "the scenarios' own": study.count("usual"),
        "step = auto": study.count("auto"),
    }
    for label, found in lines.items():
        typer.echo(f"{label + ':':16} " + ", ".join(f"{found[k]} {k}" for k in CLASSES))
    typer.echo(f"{study.wall_time:.0f} s, at most {study.memory / 1e6:.0f} MB a worker")
    for label, path in files.items():
        if path is not None:
            typer.echo(f"{label + ':':8} {path}")
