"""The command `resilin`. Exit codes: 0 done, 1 the run stopped, 2 wrong input, 130 Ctrl-C."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .errors import InputError, ResilinError

if TYPE_CHECKING:
    import xarray

    from .results import Outcome

app = typer.Typer(
    add_completion=True,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Co-simulation of a flapping-wing vehicle driven by dielectric elastomers.",
)


@app.command("run")
def run_command(
    scene: Annotated[str, typer.Argument(help="A shipped scene's name, or a TOML file.")],
    output: Annotated[
        Path | None, typer.Option(help="Result file; results/SCENE.nc if not given.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help='Start value, as amplifier.frequency="20 Hz".'),
    ] = None,
    laws: Annotated[
        str | None, typer.Option(help="How much of each port is used: held, affine, curvature.")
    ] = None,
    kind: Annotated[
        str | None, typer.Option("--master", help="gauss-seidel, jacobi or iterative.")
    ] = None,
    fmus: Annotated[Path, typer.Option(help="Folder of the built parts.")] = Path("build/fmus"),
    picture: Annotated[bool, typer.Option(help="Draw a PNG beside the result.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> None:
    """Run a scene; write its result, draw it, print the numbers that matter.

    Example: resilin run flapping-full-wings --set amplifier.frequency="20 Hz"
    """
    from .interrupt import Interrupt, Interrupted
    from .results import clear, dataset, partial_path, prepare, write
    from .run import load, run

    target = output or Path("results") / f"{Path(scene).stem}.nc"
    with Interrupt() as interrupt:
        try:
            chosen = {"laws": laws, "kind": kind}
            master = {key: value for key, value in chosen.items() if value}
            plan = load(scene, assignments(set_ or []), fmus, master=master)
            prepare(target)
            interrupt.check()
            clear(target)
            progress = not quiet and sys.stderr.isatty()
            outcome = run(plan, progress=progress, interrupt=interrupt)
            data = dataset(outcome)
            written = write(data, target)
        except Interrupted as error:
            fail(str(error), error.exit_code)
        except ResilinError as error:
            fail(str(error), error.exit_code)
    if outcome.failure is not None:
        kept = f"{len(outcome.times)} rows are kept in {partial_path(target)}"
        fail(f"{outcome.failure}; {kept}", getattr(outcome.failure, "exit_code", 1))
    if picture:
        from .picture import draw

        try:
            drawn: Path | None = draw(data, target.with_suffix(".png"))
        except OSError as error:
            fail(f"{target.with_suffix('.png')}: cannot be drawn ({error}); {written} is whole", 2)
    else:
        drawn = None
    if not quiet:
        try:
            report(outcome, data, written, drawn)
        except OSError as error:
            fail(f"standard output: {error.strerror}; {written} is whole", 1)


@app.command(
    "build",
    context_settings={"allow_extra_args": True, "ignore_unknown_options": True},
    add_help_option=False,
)
def build_command(context: typer.Context) -> None:
    """Build the parts into FMUs; the same as `python build_fmus.py`.

    Example: resilin build linkage --set linkage.stop_travel="1.9 mm" --as linkage_tight
    """
    import build_fmus

    builder = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    builder.command()(build_fmus.build_command)
    builder(args=context.args, prog_name="resilin build")


@app.command("inspect")
def inspect_command(
    scene: Annotated[str, typer.Argument(help="A shipped scene's name, or a TOML file.")],
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="Start value, as for run.")
    ] = None,
    fmus: Annotated[Path, typer.Option(help="Folder of the built parts.")] = Path("build/fmus"),
) -> None:
    """Check a scene and show what it is made of; nothing is loaded or stepped.

    Example: resilin inspect flapping-full-wings
    """
    from rich.console import Console

    from .inspection import tables
    from .run import load

    try:
        plan = load(scene, assignments(set_ or []), fmus)
    except ResilinError as error:
        fail(str(error), error.exit_code)
    for table in tables(plan):
        Console().print(table)


@app.command("scenes")
def scenes_command() -> None:
    """List the scenes that come with the package."""
    from .scenario import load_scenario, scene_names

    for name in scene_names():
        typer.echo(f"{name:24} {load_scenario(name)[0].title}")


def assignments(texts: list[str]) -> dict[str, str]:
    """`component.parameter=value` texts as a table."""
    changes = {}
    for text in texts:
        name, equals, value = text.partition("=")
        component, _, parameter = name.strip().partition(".")
        if not (equals and component and parameter):
            raise InputError(f"--set {text!r}: write component.parameter=value")
        changes[name.strip()] = value.strip()
    return changes


def report(outcome: Outcome, data: xarray.Dataset, written: Path, drawn: Path | None) -> None:
    """Print the table of metrics, and where the files are."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from .errors import printable
    from .metrics import metrics

    console = Console()
    table = Table(title=Text(printable(outcome.plan.scenario.title)), title_justify="left")
    table.add_column("metric")
    table.add_column("value", justify="right")
    for metric in metrics(data, outcome.plan.scenario.metrics.cycles):
        table.add_row(metric.name, metric.shown)
    simulated = outcome.times[-1] - outcome.times[0]
    speed = simulated / outcome.wall_time
    console.print(table)
    console.print(
        f"{outcome.steps} communication steps, {simulated:.3f} s simulated in"
        f" {outcome.wall_time:.2f} s, {speed:.1f} times real time",
        highlight=False,
    )
    for label, path in (("result: ", written), ("picture:", drawn)):
        if path is not None:
            shown = Text(f"{label} {printable(str(path), most=1000)}")
            console.print(shown, soft_wrap=True)


def fail(message: str, code: int) -> None:
    """Print each line of a message as an error and leave with an exit code."""
    from .errors import printable

    for line in message.split("\n"):
        typer.echo(f"resilin: {printable(line, most=900)}", err=True)
    raise typer.Exit(code)


def main() -> None:
    """Run the command; what the terminal cannot show is escaped, not an error."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")
    try:
        app()
    except KeyboardInterrupt:
        raise SystemExit(130) from None


def entry() -> None:
    """The command of the package: `main`, then out without tearing down the interpreter.

    PythonFMU's library touches freed memory when the process takes it down; everything of
    ours is closed and flushed by then.
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


if __name__ == "__main__":
    entry()
