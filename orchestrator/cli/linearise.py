"""`resilin linearise`: poles, frequency response and coupling stability of a scenario at rest."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import common

if TYPE_CHECKING:
    from ..scenario.plan import Plan
    from ..simulation.linear.state_space import Linear


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("linearise")(linearise)


def linearise(
    scenario: common.ScenarioName,
    input_: Annotated[
        list[str] | None, typer.Option("--input", help="Held input to perturb; all if not given.")
    ] = None,
    output: Annotated[
        list[str] | None, typer.Option(help="Recorded variable; all if not given. May repeat.")
    ] = None,
    set_: common.Sets = None,
    hold: Annotated[
        list[str] | None,
        typer.Option(help='Value of a held input, as amplifier.command.top="1 kV".'),
    ] = None,
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
    bode: Annotated[
        Path | None, typer.Option(help="Draw the frequency response into this file.")
    ] = None,
    swept: Annotated[
        Path | None,
        typer.Option("--beside", help="Draw a sweep over frequency beside it, as points."),
    ] = None,
    drive: Annotated[str, typer.Option(help="Amplitude of that sweep's drive, as 960 V.")] = "1",
    fmus: common.Library = common.BUILT,
    json: common.Json = False,
) -> None:
    """Linearise a scenario about its state of rest, through the FMUs alone.

    A driven one is at rest once a cycle: --interval "1 cycle".

    Example: resilin linearise oscillator-1 --set amplifier.waveform=external
    --hold amplifier.command.top="1 kV" --bode bode.svg
    """
    from ..simulation.linear.state_space import AVERAGED, MARKOV
    from ..simulation.linear.state_space import linearise as linearised
    from ..simulation.linear.step_map import MAPPED, step_map
    from ..simulation.load import load

    with common.reported():
        options: dict[str, Any] = common.overrides(laws, kind, step=step)
        held = common.assignments(hold, "--hold")
        plan = load(scenario, common.assignments(set_), fmus, **options, hold=held)
        if interval is None:
            found = linearised(plan, input_, output)
            mapped = step_map(plan)
            radii = {name: mapped.radius(name) for name in MAPPED}
        else:
            every = _seconds(interval, plan)
            found = linearised(plan, input_, output, count=MARKOV, interval=every, nudge=AVERAGED)
            radii = {}
        if bode is not None:
            from ..studies.frequency_response import beside, draw

            points = beside(swept, _amplitude(found, drive)) if swept else None
            draw(found, bode, plan.frequency, points)
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


def _amplitude(found: Linear, text: str) -> float:
    """A drive's amplitude in the unit of the first input."""
    from ..errors import InputError
    from ..units import UnitError, si_value

    try:
        value = si_value(text, found.units[found.inputs[0]] or "1")
    except UnitError as error:
        raise InputError(f"--drive: {error}") from None
    if not value > 0.0:
        raise InputError(f"--drive {text!r}: has to be above zero")
    return value


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
