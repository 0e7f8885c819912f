"""`resilin paper`: the paper's figures and tables from runs, beside its own numbers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common
from .command_list import PAPER
from .renamed_options import known_as

if TYPE_CHECKING:
    from ..studies.paper.reproduction import Reproduction

TARGET = Path("results") / "paper" / "paper.html"


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command(
        "paper", rich_help_panel=PAPER, cls=known_as(pictures="picture", no_pictures="no_picture")
    )(paper)


def paper(
    items: Annotated[
        list[str] | None,
        typer.Argument(help="figure3, figure7, table1, ..., or hovering, ...; all if not given."),
    ] = None,
    output: Annotated[
        Path, typer.Option(help="HTML page; plots and finished runs go beside it.")
    ] = TARGET,
    workers: common.Workers = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    picture: common.Picture = True,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Run the paper's figures and tables; write one page.

    It shows the error of each number. Finished runs are kept beside the page, and repeated only if
    scenario, FMUs or version change.

    \b
    Example: resilin paper figure11 equation6
    """
    from ..report.page import check_page, write
    from ..simulation.interrupt import Interrupt
    from ..studies.paper.cached_runs import CachedRuns
    from ..studies.paper.page import facts, page, pictures
    from ..studies.paper.reproduction import chosen, reproduced
    from ..studies.run_cache import RunCache

    shown = sys.stderr.isatty() and not (quiet or json)

    def tell(done: int, total: int) -> None:
        if shown:
            typer.echo(f"\r{done} of {total} runs ", nl=done == total, err=True)

    with Interrupt() as interrupt, common.reported():
        names = chosen(items or [])
        parts = common.library(fmus, native)
        check_page(output)
        runs = RunCache(output.with_name(f"{output.stem}.runs"))
        with CachedRuns(parts, runs, workers, interrupt.check, tell) as cached_runs:
            found = reproduced(names, cached_runs)
        written = write(page(found, parts), output)
        drawn = pictures(found, output.parent) if picture else []
    if json:
        files = {"page": str(written), "pictures": [str(path) for path in drawn]}
        common.print_json(files | facts(found))
    elif not quiet:
        _report(found)
        typer.echo(f"{found.ran} runs, {found.wall_time:.1f} s\npage:    {written}")
    for failure in found.failures:
        typer.echo(f"resilin: {failure}", err=True)
    if found.failures:
        raise typer.Exit(1)


def _report(found: Reproduction) -> None:
    from rich.table import Table

    from ..errors import printable
    from ..studies.paper.page import texts

    table = Table("quantity", "reading", "paper", "ours", "error", "mark")
    for item in found.items:
        for row in item.rows:
            paper, ours, error = texts(row)
            cells = (row.number.quantity, row.reading, paper, ours, error, row.mark.kind)
            table.add_row(*(printable(cell.replace("\N{NO-BREAK SPACE}", " ")) for cell in cells))
    common.console().print(table)
