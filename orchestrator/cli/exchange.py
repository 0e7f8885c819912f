"""`resilin schema`: what editors and other tools need to know of scenes."""

from __future__ import annotations

import typer

from . import common


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("schema")(schema)


def schema() -> None:
    """Print the JSON Schema of scene files, for completion and checks in an editor.

    Example: resilin schema > scene.schema.json
    """
    from ..scenario import json_schema

    common.print_json(json_schema())
