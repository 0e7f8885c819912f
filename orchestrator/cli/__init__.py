"""The command `resilin`.

Exit codes: 0 done; 1 the run stopped, its rows are kept; 2 wrong input, nothing is written;
130 Ctrl-C, 143 SIGTERM, 129 a closed terminal, rows kept.
"""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from typing import Annotated, Any

import typer

from ..errors import KeptWarning, RenamedWarning, printable
from . import (
    build,
    calibrate,
    check,
    command_list,
    compare,
    exchange,
    fit,
    inspect,
    linearise,
    new,
    paper,
    parts,
    plot,
    precision,
    record,
    results,
    run,
    stability,
    sweep,
)

app = typer.Typer(
    cls=command_list.CommandList,
    add_completion=True,
    rich_markup_mode=None,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Co-simulation of a flapping-wing vehicle driven by dielectric elastomers.",
    epilog=(
        "A law is what a port passes beside its value: how that changes with motion and time, and"
        " its curvature; a value that is passed alone is held over a step.\n"
        "Exit codes: 0 done, 1 the run stopped, 2 wrong input, 130 Ctrl-C, 143 SIGTERM."
    ),
)


def _print_version(asked: bool) -> None:
    if asked:
        from ..results.netcdf import release

        typer.echo(f"resilin {release()}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", is_eager=True, callback=_print_version
        ),
    ] = False,
) -> None:
    """Options that stand before any command."""


for module in (
    run,
    record,
    sweep,
    precision,
    stability,
    linearise,
    fit,
    results,
    plot,
    compare,
    build,
    new,
    parts,
    check,
    inspect,
    exchange,
    paper,
    calibrate,
):
    module.add_to(app)


def main() -> None:
    """Run the command; what the terminal cannot show is escaped, not an error."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")
    warnings.showwarning = _shown  # type: ignore[assignment]
    try:
        app()
    except KeyboardInterrupt:
        raise SystemExit(130) from None


def _shown(message: Warning | str, category: type[Warning], *_: Any) -> None:
    """A warning as one line on standard error; those for programmers are not shown."""
    if issubclass(category, (RenamedWarning, KeptWarning)):
        typer.echo(f"resilin: warning: {printable(str(message), most=900)}", err=True)


def entry() -> None:
    """The command of the package: `main`, then the end without tearing down the interpreter.

    PythonFMU's library touches freed memory when the process unloads it; all of our files are
    closed and flushed by then.
    """
    code: object = 0
    try:
        main()
    except SystemExit as error:
        code = error.code
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code if isinstance(code, int) else int(code is not None))
