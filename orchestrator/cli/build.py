"""`resilin build`: parts as FMUs."""

from __future__ import annotations

import typer

from .command_list import PARTS


def add_to(app: typer.Typer) -> None:
    """Register the command, whose options are the builder's own."""
    settings = {"allow_extra_args": True, "ignore_unknown_options": True}
    app.command("build", rich_help_panel=PARTS, context_settings=settings, add_help_option=False)(
        build
    )


def build(context: typer.Context) -> None:
    """Build the parts into FMUs, Python and compiled.

    The same as `python build_fmus.py`.

    \b
    Example: resilin build linkage --set linkage.stop_travel="1.9 mm" --as linkage_tight
    """
    import build_fmus

    build_fmus.builder()(args=context.args, prog_name="resilin build")
