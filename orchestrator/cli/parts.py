"""`resilin parts`: the built parts, and what can be set and wired on one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from . import common, completion
from .command_list import PARTS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("parts", rich_help_panel=PARTS)(parts)


def parts(
    part: Annotated[
        str | None,
        typer.Argument(
            help="A part, or an .fmu file; all parts are listed if none.",
            autocompletion=completion.parts,
        ),
    ] = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    json: common.Json = False,
) -> None:
    """List the parts; or show one: its parameters and ports.

    \b
    Example: resilin parts amplifier
    """
    with common.reported():
        library = common.library(fmus, native)
        if part is None:
            _list(library, json)
        else:
            show(part, library, json)


def show(part: str, library: Path, json: bool) -> None:
    """Print what a part offers, given by name or as a file."""
    from ..scenario.part_inspection import description_of, part_facts, part_tables
    from ..scenario.plan import interface_of

    interface = interface_of(part, Path(), library)
    if json:
        common.print_json(part_facts(interface))
        return
    typer.echo(f"{interface.path}: {description_of(interface.path)}")
    if interface.model_exchange:
        from ..fmi.instance.integrated import TOLERANCE

        typer.echo(f"for model exchange: CVODE integrates it, relative tolerance {TOLERANCE:g}")
    for table in part_tables(interface):
        common.console().print(table)


def _list(library: Path, json: bool) -> None:
    from ..scenario.library import built_part, nothing_built, part_names
    from ..scenario.part_inspection import description_of

    found = {name: built_part(name, library) for name in part_names(library)}
    if not found:
        if library == common.BUILT:
            raise InputError(nothing_built())
        raise InputError(f"the folder {library} holds no FMU; run: resilin build")
    described = {name: description_of(path) for name, path in found.items()}
    if json:
        common.print_json(
            [
                {"part": name, "fmu": str(found[name]), "description": text}
                for name, text in described.items()
            ]
        )
        return
    for name, text in described.items():
        typer.echo(f"{name:12} {text}")
