"""`resilin results`: the results that are there."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import printable
from . import common
from .command_list import RESULTS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("results", rich_help_panel=RESULTS)(results)


def results(
    folder: Annotated[Path, typer.Argument(help="Folder of results.")] = common.RESULTS,
    json: common.Json = False,
) -> None:
    """List the results in a folder, the newest first.

    Example: resilin results
    """
    from ..results.listing import results_in

    with common.reported():
        found = results_in(folder)
    if json:
        common.print_json(
            [
                {
                    "result": str(entry.path),
                    "kind": entry.kind,
                    "title": entry.title,
                    "extent": entry.extent,
                    "written": entry.written.isoformat(timespec="seconds"),
                    "bytes": entry.size,
                }
                for entry in found
            ]
        )
        return
    if not found:
        typer.echo(f"no results in {folder}")
        return
    from rich.table import Table
    from rich.text import Text

    names = [printable(entry.path.name) for entry in found]
    table = Table()
    table.add_column("result", min_width=max(map(len, names)))
    table.add_column("holds", no_wrap=True)
    table.add_column("written", no_wrap=True)
    for name, entry in zip(names, found, strict=True):
        title = f"\n{printable(entry.title)}" if entry.title else ""
        holds = f"{entry.kind}\n{entry.extent}"
        table.add_row(Text(f"{name}{title}"), holds, f"{entry.written:%d %b %H:%M}")
    common.console().print(table)
