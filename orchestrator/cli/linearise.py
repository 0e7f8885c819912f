"""`resilin linearise`: poles, frequency response and coupling stability of a scenario at rest."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import common
from .command_list import RUNS
from .renamed_options import known_as

if TYPE_CHECKING:
    from ..scenario.plan import Plan
    from ..simulation.linear.state_space import Linear
    from ..studies.frequency_response import Beside


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("linearise", rich_help_panel=RUNS, cls=known_as(bode="output"))(linearise)


def linearise(
    scenario: common.ScenarioName,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input", help="Input without a wire, to perturb; may repeat. All if not given."
        ),
    ] = None,
    variables: common.Variables = None,
    output: Annotated[
        Path | None, typer.Option(help="Plot of the frequency response, as .png, .svg or .pdf.")
    ] = None,
    set_: common.Sets = None,
    hold: common.Holds = None,
    kind: common.Kind = None,
    laws: common.Laws = None,
    step: common.Step = None,
    interval: Annotated[
        str | None,
        typer.Option(
            help='See the system at this interval, as "1 cycle" of a drive that is on: the averaged'
            " model. The communication step if not given."
        ),
    ] = None,
    swept: Annotated[
        Path | None,
        typer.Option("--beside", help="Sweep over frequency to draw into the plot, as points."),
    ] = None,
    drive: Annotated[str, typer.Option(help="Amplitude of that sweep's drive, as 960 V.")] = "1",
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    json: common.Json = False,
) -> None:
    """Linearise a scenario at rest: poles, frequency response.

    It is done through the FMUs alone, and shows the recorded variables that answer. A driven one
    is at rest once a cycle: --interval "1 cycle".

    \b
    Example: resilin linearise oscillator-1 --set amplifier.waveform=external \\
      --hold amplifier.command.top="1 kV" --output bode.svg
    """
    from ..errors import InputError
    from ..report.image import check_plot
    from ..simulation.linear.state_space import AVERAGED, MARKOV, signals
    from ..simulation.linear.state_space import linearise as linearised
    from ..simulation.linear.step_map import MAPPED, step_map
    from ..simulation.load import load, unloaded

    with common.reported():
        options: dict[str, Any] = common.overrides(laws, kind, step=step)
        held = common.assignments(hold, "--hold")
        library = common.library(fmus, native, scenario)
        if output is not None:
            check_plot(output, common.PLOT_ONLY)
        elif swept is not None:
            raise InputError("--beside: goes into the plot of --output; name that too")
        changes = common.assignments(set_)
        first = unloaded(scenario, changes, library, **options, hold=held)
        nudged, _ = signals(first, inputs, variables, driven=interval is not None)
        points = _points(swept, drive, first, nudged[0]) if swept is not None else None
        plan = load(scenario, changes, library, **options, hold=held)
        if interval is None:
            found = linearised(plan, inputs, variables)
            mapped = step_map(plan)
            radii = {name: mapped.radius(name) for name in MAPPED}
        else:
            every = _seconds(interval, plan)
            found = linearised(
                plan, inputs, variables, count=MARKOV, interval=every, nudge=AVERAGED
            )
            radii = {}
        if output is not None:
            from ..studies.frequency_response import draw

            draw(found, output, plan.frequency, points)
    if json:
        poles = found.eigenvalues()
        common.print_json(
            {
                "poles": [[pole.real, pole.imag] for pole in poles],
                "spectral_radius": radii,
                "rest": dict(zip(found.outputs, found.rest.tolist(), strict=True)),
                "left_out": found.left_out,
                "error_on_second_record": found.matched,
            }
        )
        return
    _report(found, radii)


def _seconds(text: str, plan: Plan) -> float:
    """A sampling interval [s], in seconds or in cycles of a scenario."""
    from ..errors import Problems
    from ..scenario.time_grid import seconds

    problems = Problems(plan.path)
    every = seconds("--interval", text, plan.frequency, problems)
    problems.check()
    return every


def _points(path: Path, text: str, plan: Plan, driven: str) -> Beside:
    """A sweep by its drive, whose amplitude is a text in the unit of the input that is driven."""
    from ..errors import InputError
    from ..studies.frequency_response import beside
    from ..units import UnitError, si_value

    component, _, name = driven.partition(".")
    try:
        value = si_value(text, plan.interfaces[component].variables[name].unit or "1")
    except UnitError as error:
        raise InputError(f"--drive: {error}") from None
    if not value > 0.0:
        raise InputError(f"--drive {text!r}: has to be above zero")
    return beside(path, value)


def _report(found: Linear, radii: dict[str, float]) -> None:
    import numpy as np
    from rich.table import Table

    table = Table("pole (1/s)", "natural frequency", "damping ratio", title="poles, slowest first")
    for pole in found.eigenvalues():
        if pole.imag < 0.0:
            continue
        size = abs(pole)
        text = f"{pole.real:.6g}" + (f" +- {pole.imag:.6g} i" if pole.imag else "")
        table.add_row(text, f"{size / (2 * np.pi):.5g} Hz", f"{-pole.real / size:.5g}")
    console = common.console()
    console.print(table)
    console.print(f"error on a second record: {found.matched:.1e}", highlight=False)
    for name, reason in found.left_out.items():
        console.print(f"left out: {name} {reason}", highlight=False, soft_wrap=True)
    for name, radius in radii.items():
        verdict = "stable" if radius <= 1.0 + 1e-6 else "unstable"
        console.print(f"{name} at this step: spectral radius {radius:.6f}, {verdict}")
