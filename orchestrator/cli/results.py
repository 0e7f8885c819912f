"""`resilin results`: the results that are there."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..errors import printable
from . import common, completion
from .command_list import RESULTS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("results", rich_help_panel=RESULTS)(results)


def results(
    folder: Annotated[
        Path,
        typer.Argument(
            help="Folder of results, or the name of one.", autocompletion=completion.results
        ),
    ] = common.RESULTS,
    json: common.Json = False,
) -> None:
    """List the results in a folder, the newest first.

    It shows what was changed against the scenario, and marks what is not to be used.

    \b
    Example: resilin results
    """
    from ..results.listing import entry_of, results_in

    with common.reported():
        listed = folder.is_dir() or folder == common.RESULTS
        found = results_in(folder) if listed else [entry_of(common.result_file(folder))]
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
                    **asdict(entry.notes),
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
        notes = entry.notes
        lines = [name]
        lines += [printable(entry.title)] * bool(entry.title)
        lines += [f"with {notes.changed}"] * bool(notes.changed)
        lines += [f"NOT TO BE USED: {notes.verdict}"] * bool(notes.verdict)
        holds = [entry.kind, entry.extent]
        if notes.warnings:
            holds.append(f"{len(notes.warnings)} warning" + "s" * (len(notes.warnings) != 1))
        table.add_row(Text("\n".join(lines)), "\n".join(holds), f"{entry.written:%d %b %H:%M}")
    common.console().print(table)
