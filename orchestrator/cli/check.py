"""`resilin check`: what is wrong with FMU files, and whether they can be used all the same."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import FmuError, printable
from . import common
from .command_list import PARTS

SCENARIOS = (".toml", ".ssp")


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("check", rich_help_panel=PARTS)(check)


def check(
    names: Annotated[
        list[str],
        typer.Argument(help="FMU files, parts or scenarios, by name or path.", metavar="NAME..."),
    ],
    strict: Annotated[
        bool, typer.Option("--strict", help="Count warnings and what fmpy finds as errors.")
    ] = False,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
) -> None:
    """List what is wrong with FMU files.

    Also by fmpy's validation. Of a scenario all FMUs are checked; what `resilin inspect` refuses is
    refused. The exit code is 1 where there are errors.

    \b
    Example: resilin check build/fmus/spring.fmu
    """
    with common.reported():
        files = [path for name in names for path in _files(name, fmus, native)]
    failed = False
    for path in dict.fromkeys(files):
        errors, warnings = _findings(path)
        for kind, texts in (("error", errors), ("warning", warnings)):
            for text in texts:
                typer.echo(f"{path}: {kind}: {printable(text, most=900)}")
        verdict = "refused" if errors else "usable"
        counts = (f"{len(errors)} error", errors), (f"{len(warnings)} warning", warnings)
        listed = ", ".join(text + "s" * (len(found) != 1) for text, found in counts)
        typer.echo(f"{path}: {verdict}; {listed}")
        failed |= bool(errors or (strict and warnings))
    if failed:
        raise typer.Exit(1)


def _files(name: str, fmus: Path, native: bool | None) -> list[Path]:
    """The FMU that a path or a part's name stands for, or those of a scenario's components."""
    from ..scenario.files import is_file, scenario_names
    from ..scenario.library import built_part, part_names
    from ..simulation.load import unloaded

    scenario = name.endswith(SCENARIOS) or name in scenario_names()
    if name.endswith(".fmu") or (not scenario and is_file(Path(name))):
        return [Path(name)]
    library = common.library(fmus, native, name)
    if not scenario and name in part_names(library):
        return [built_part(name, library)]
    plan = unloaded(name, library=library)
    components = plan.scenario.components
    return [known.path for key, known in plan.interfaces.items() if components[key].fmu]


def _findings(path: Path) -> tuple[list[str], list[str]]:
    """Errors and warnings of one FMU; fmpy's findings are warnings."""
    from fmpy import platform, platform_tuple
    from fmpy.validation import validate_fmu

    from ..fmi.archive import platforms
    from ..fmi.description import examined

    try:
        interface, found = examined(path)
        available = platforms(path)
    except FmuError as error:
        return [text.removeprefix(f"{path}: ") for text in error.problems], []
    where = "modelDescription.xml: "
    errors = [where + text for text in found.errors]
    place = str(platform if interface is not None and interface.version == 2 else platform_tuple)
    if interface is not None and place not in available:
        errors.append(f"no binary for {place} (available: {', '.join(available) or 'none'})")
    fmpy = [f"fmpy: {text.strip()}" for text in validate_fmu(str(path))]
    return errors, [where + text for text in found.warnings] + fmpy
