"""`resilin calibrate`: the fits behind the scenarios, repeated or evaluated."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common
from .command_list import PAPER
from .renamed_options import known_as

if TYPE_CHECKING:
    from ..simulation.interrupt import Interrupt
    from ..studies.calibration import Fit


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("calibrate", rich_help_panel=PAPER, cls=known_as(file="fits"))(calibrate)


def calibrate(
    fit: Annotated[list[str] | None, typer.Argument(help="Fits by name; all if none.")] = None,
    fits: Annotated[
        Path | None, typer.Option(help="TOML file of fits; the shipped one if not given.")
    ] = None,
    refit: Annotated[
        bool, typer.Option(help="Fit again; else the shipped values are evaluated.")
    ] = True,
    profile: Annotated[
        bool, typer.Option(help="Fit at each share of the fits' profiles instead; takes minutes.")
    ] = False,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
) -> None:
    """Fit parameters to the paper's data again.

    It shows errors, sensitivities and spreads.

    \b
    Example: resilin calibrate vehicle vehicle-long-rocker --no-refit --native
    """
    from ..simulation.interrupt import Interrupt
    from ..studies.calibration import calibrate as study_calibrate
    from ..studies.calibration import load_fits, shipped
    from ..studies.calibration.table import data, facts, parameters, sensitivities

    shown = sys.stderr.isatty() and not (quiet or json)
    tell = (lambda text: typer.echo(text, err=True)) if shown else None
    if profile:
        with Interrupt() as interrupt, common.reported():
            parts = common.library(fmus, native, fits)
            wanted = [one for one in load_fits(fits or shipped(), fit) if one.profile or fit]
            _profile(wanted, parts, interrupt, tell, json, quiet)
        return
    with Interrupt() as interrupt, common.reported():
        library = common.library(fmus, native, fits)
        found = [
            study_calibrate(
                one,
                library,
                refit=refit,
                interrupt=interrupt,
                tell=tell,
            )
            for one in load_fits(fits or shipped(), fit)
        ]
    if json:
        common.print_json([facts(one) for one in found])
    elif not quiet:
        for one in found:
            common.console().print(parameters(one))
            common.console().print(data(one))
            common.console().print(sensitivities(one))
            values = ", ".join(f"{value:.3g}" for value in one.singular)
            typer.echo(f"singular values of the sensitivities: {values}")
            typer.echo(f"{one.runs} runs in {one.wall_time:.1f} s; {one.message}")


def _profile(
    fits: Sequence[Fit], library: Path, interrupt: Interrupt, tell: Callable[[str], None] | None,
    json: bool, quiet: bool,
) -> None:  # fmt: skip
    """The profiles of these fits, as tables or for scripts."""
    from ..studies.calibration import profile
    from ..studies.calibration.table import point_facts, points

    found = [(fit, profile(fit, library, interrupt, tell)) for fit in fits]
    if json:
        common.print_json([point_facts(fit, each) for fit, each in found])
    elif not quiet:
        for fit, each in found:
            common.console().print(points(fit, each))
