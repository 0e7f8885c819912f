"""`resilin fit`: parameters of parts from a recording."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common
from .command_list import RUNS
from .renamed_options import known_as

if TYPE_CHECKING:
    from ..studies.identification import Identified


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command(
        "fit",
        rich_help_panel=RUNS,
        cls=known_as(picture="output", parameters="parameter", scene="scenario"),
    )(fit)


def fit(
    recording: Annotated[Path, typer.Argument(help="File with recorded inputs and outputs.")],
    part: Annotated[
        list[str], typer.Option(help="Part, FMU file, or with --scenario a component; may repeat.")
    ],
    parameters: Annotated[
        list[str],
        typer.Option(
            "--parameter", help='As mass, "mass=0.3 g:2 g", or spring.damping; may repeat.'
        ),
    ],
    scenario: Annotated[
        str | None, typer.Option(help="Scenario of the parts: its wires and start values.")
    ] = None,
    variables: common.Variables = None,
    output: Annotated[
        Path | None,
        typer.Option(help="Plot; results/RECORDING-fit.png if not given. Also .svg, .pdf."),
    ] = None,
    keys: Annotated[
        list[str] | None,
        typer.Option("--with", help="Key of a recording, as interpolation=linear; may repeat."),
    ] = None,
    hold: common.Holds = None,
    set_: common.Sets = None,
    step: Annotated[
        str | None, typer.Option(help="Communication step; the rows of the file if not given.")
    ] = None,
    skip: Annotated[str, typer.Option(help='First stretch that does not count, as "0.1 s".')] = (
        "0 s"
    ),
    level: Annotated[
        float, typer.Option(help="Share of fits whose interval is to contain the value.")
    ] = 0.95,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    html: common.Html = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Fit parameters of parts to a recording.

    It is done by least squares, over the recorded outputs or those of --variable.

    \b
    Example: resilin fit bench.csv --part payload --parameter mass --native
    """
    from ..errors import InputError
    from ..report.image import check_plot, draw
    from ..report.page import check_page, write
    from ..simulation.interrupt import Interrupt
    from ..studies.identification import Asked, Settings, case_of, identify, unknowns_of
    from ..studies.identification.table import facts, figure, page
    from ..units import UnitError, si_value

    shown = sys.stderr.isatty() and not (quiet or json)
    target = output or Path("results") / f"{recording.stem}-fit.png"
    with Interrupt() as interrupt, common.reported():
        if html is not None:
            check_page(html)
        check_plot(target, common.PLOT_ONLY)
        if not 0.0 < level < 1.0:
            raise InputError(f"--level {level:g}: has to be between 0 and 1")
        try:
            late = si_value(skip, "s")
            size = None if step is None else si_value(step, "s")
        except UnitError as error:
            raise InputError(f"--step, --skip: {error}") from None
        if late < 0.0 or (size is not None and size <= 0.0):
            raise InputError("--step has to be above zero, --skip not below it")
        asked = Asked(
            part, scenario, pairs(keys, "--with"), pairs(hold, "--hold"), tuple(variables or ()),
            pairs(set_, "--set"), size,
        )  # fmt: skip
        case = case_of(recording, asked, common.library(fmus, native, scenario or recording))
        names = [name for name in case.plan.scenario.components if name != "recording"]
        unknowns = unknowns_of(
            [name for text in parameters for name in text.split(",")], case.plan, names
        )
        found = identify(
            case, unknowns, Settings(late, level), interrupt=interrupt,
            tell=(lambda text: typer.echo(text, err=True)) if shown else None,
        )  # fmt: skip
        draw(figure(found), [target])
        written = write(page(found), html) if html is not None else None
    if json:
        common.print_json(facts(found) | {"picture": str(target), "page": str(written or "")})
    elif not quiet:
        _report(found, [target, *([written] if written else [])])


def pairs(texts: list[str] | None, option: str) -> dict[str, str]:
    """`key=value` texts of an option; a key may hold dots, and blanks in a heading."""
    from ..errors import InputError

    found = {}
    for text in texts or []:
        key, equals, value = text.rpartition("=") if option == "--with" else text.partition("=")
        if not (equals and key.strip()):
            raise InputError(f"{option} {text!r}: write key=value")
        found[key.strip()] = value.strip().strip('"')
    return found


def _report(found: Identified, files: list[Path]) -> None:
    from rich.text import Text

    from ..errors import printable
    from ..studies.identification.table import objections, outputs, parameters, remarks

    console = common.console()
    console.print(parameters(found))
    for line in objections(found):
        console.print(Text(line, style="bold red"), soft_wrap=True)
    console.print(outputs(found))
    for line in remarks(found):
        console.print(Text(f"remark: {line}"), soft_wrap=True)
    for path in files:
        console.print(Text(f"written: {printable(str(path), most=1000)}"), soft_wrap=True)
