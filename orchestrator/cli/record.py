"""`resilin record`: the outputs of a part, as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import common


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("record")(record)


def record(
    scenario: common.ScenarioName,
    part: Annotated[str, typer.Option(help="Component of the scenario whose outputs are kept.")],
    output: Annotated[
        Path | None,
        typer.Option(help="Recording, .csv or .nc; results/SCENARIO-PART.csv if not given."),
    ] = None,
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    stop: common.Stop = None,
    step: common.Step = None,
    tolerance: common.Tolerance = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = False,
    quiet: common.Quiet = False,
) -> None:
    """Run a scenario and keep the outputs of one part, as a recording that can take its place.

    Example: resilin record flapping-full-wings --part amplifier --stop "10 cycles"
    """
    from ..errors import OutputError
    from ..results.netcdf import prepare
    from ..results.port_recording import with_recorded_ports, write_port_recording
    from ..simulation.interrupt import Interrupt
    from ..simulation.load import load
    from ..simulation.run import run

    with Interrupt() as interrupt, common.reported():
        target = output or Path("results") / f"{Path(scenario).stem}-{part}.csv"
        if target.suffix not in {".csv", ".nc"}:
            raise OutputError(f"{target}: recordings are written as .csv or .nc")
        options = common.overrides(laws, kind, stop, step, tolerance)
        library = common.library(fmus, native)
        plan = with_recorded_ports(
            load(scenario, common.assignments(set_), library, **options), part
        )
        prepare(target.with_suffix(".nc"))
        outcome = run(plan, interrupt=interrupt, estimate=False)
        written = write_port_recording(outcome, target)
        if not quiet:
            typer.echo(f"{outcome.kept} rows of {len(outcome.names)} variables: {written}")
        if outcome.failure is not None:
            raise outcome.failure
