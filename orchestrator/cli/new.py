"""`resilin new`: the folder of a part of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from . import common
from .command_list import PARTS


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    group = typer.Typer(
        no_args_is_help=True, help="Write the folder of a part of one's own: new part NAME."
    )
    group.command("part")(part)
    app.add_typer(group, name="new", rich_help_panel=PARTS)


def part(
    name: Annotated[str, typer.Argument(help="Name of the part and of its folder.")],
    into: Annotated[Path, typer.Option(help="Where the folder goes.")] = Path(),
) -> None:
    """Write a folder with physics, reference answer and test.

    \b
    Example: resilin new part coil
    """
    import build_fmus

    with common.reported():
        try:
            folder = build_fmus.new_part(name, into)
        except build_fmus.BuildError as error:
            raise InputError(str(error)) from None
    shown = folder if folder.is_absolute() else f"./{folder}"
    typer.echo(
        f"{shown} is a spring that hardens. Put your equation into physics.py, its words into\n"
        f"slave.py and README.md, known answers into reference.csv, its test into test_{name}.py;\n"
        f"then: resilin build {shown}"
    )
