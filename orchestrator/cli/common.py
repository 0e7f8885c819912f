"""What the commands share: options, assignments, errors, output for scripts."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, ResilinError, nearest, printable
from . import completion

if TYPE_CHECKING:
    from rich.console import Console

    from ..studies.precision.method import Method

ScenarioName = Annotated[
    str,
    typer.Argument(
        help="A shipped scenario's name, or a TOML file.", autocompletion=completion.scenarios
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Start value, as amplifier.frequency=20Hz; may repeat.",
        autocompletion=completion.start_values,
    ),
]
Laws = Annotated[
    str | None,
    typer.Option(
        help="What a port passes for a step: its value (held), how it changes with motion and time"
        " (affine), and its curvature (curvature).",
        autocompletion=completion.laws,
    ),
]
Kind = Annotated[
    str | None,
    typer.Option(
        "--master",
        help="gauss-seidel, jacobi, extrapolated, iterative or interface-newton.",
        autocompletion=completion.masters,
    ),
]
MethodTexts = Annotated[
    list[str] | None,
    typer.Option(
        "--method", help="Master, or master/laws as jacobi/held; may repeat. All if not given."
    ),
]
Variables = Annotated[
    list[str] | None,
    typer.Option("--variable", help="Variable, or pattern as linkage.*; may repeat."),
]
Holds = Annotated[
    list[str] | None,
    typer.Option("--hold", help="Value of an input without a wire, as force.value=0N; may repeat."),
]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes; as many as processors if not given.")
]
Patience = Annotated[float | None, typer.Option(help="Seconds that one run may take.")]
Picture = Annotated[bool, typer.Option("--picture/--no-picture", help="Draw pictures too.")]
Library = Annotated[
    Path,
    typer.Option(
        "--fmus",
        help="Folder of the built parts; the nearest build/ with the part if none.",
        show_default=False,
    ),
]
Native = Annotated[
    bool | None,
    typer.Option(
        "--native/--python",
        help="Compiled parts only, or Python parts only; if neither, compiled where up to date.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON for scripts, nothing else.")]
Html = Annotated[
    Path | None, typer.Option("--html", help="Write everything as a page that opens offline.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print errors only.")]
Stop = Annotated[str | None, typer.Option(help='End of the run, as "2 s" or "40 cycles".')]
Step = Annotated[
    str | None, typer.Option(help='Communication step, as "0.1 ms" or "100 per cycle".')
]
Tolerance = Annotated[
    float | None, typer.Option(help="Let an error estimate choose the steps, as 1e-3.")
]
Name = Annotated[
    str | None, typer.Option("--name", help="Name of the result; the scenario's if not given.")
]
BUILT = Path("build")
"""Where the build command puts parts of both kinds."""
PLOT_ONLY = "plots are pictures, and variables are chosen by --variable"
"""For commands whose `--output` was a variable in earlier releases."""
RESULTS = Path("results")
"""Where results go that are given no path."""


def result_path(scenario: str, output: Path | None, name: str | None, ending: str = ".nc") -> Path:
    """File of a result: as given, or in the folder of results by its name or the scenario's."""
    if output is not None:
        if name is not None:
            raise InputError("--name and --output both name the result: give one")
        return output
    if name is not None and (not name.strip(".") or Path(name).name != name):
        raise InputError(
            f"--name {printable(name)!r}: is not the name of a file; --output takes paths"
        )
    return RESULTS / f"{Path(scenario).stem if name is None else name}{ending}"


def result_file(given: Path) -> Path:
    """A result by its path, or by its name in the folder of results; `InputError` with a near one.

    A path that is not there may be that of a file beside others: these are then what is offered.
    """
    from ..scenario.files import is_file

    if is_file(given):
        return given
    folder = given.parent if given.name != str(given) else RESULTS
    for name in (given.name, f"{given.name}.nc"):
        if is_file(folder / name):
            return folder / name
    shown = printable(str(given), most=1000)
    try:
        known = [path.stem for path in folder.glob("*.nc")]
    except (OSError, ValueError):
        known = []
    hint = nearest(given.name.removesuffix(".nc"), known) if known else "resilin run makes one"
    raise InputError(f"{shown}: no such result; {hint}")


def run_names(paths: Sequence[Path]) -> dict[str, Path]:
    """Short names of results: their files' names, or whole paths where these are the same."""
    stems = [path.stem for path in paths]
    names = stems if len(set(stems)) == len(stems) else [str(path) for path in paths]
    found = dict(zip(names, paths, strict=True))
    if len(found) < len(paths):
        raise InputError("a result is given twice; give different ones")
    return found


def assignments(texts: list[str] | None, option: str = "--set") -> dict[str, str]:
    """`component.name=value` texts of an option as a table."""
    changes = {}
    for text in texts or []:
        name, equals, value = text.partition("=")
        component, _, parameter = name.strip().partition(".")
        if not (equals and component and parameter):
            raise InputError(f"{option} {text!r}: write component.parameter=value")
        changes[name.strip()] = value.strip()
    return changes


def library(fmus: Path, native: bool | None, scenario: str | Path | None = None) -> Path:
    """Folder in which the parts are found, for a scenario given by its name or path."""
    from ..scenario.library import NATIVE, PYTHON, is_library, located, of_kind

    found = located(fmus, None if scenario is None else Path(scenario))
    if native is None:
        return found
    kind = NATIVE if native else PYTHON
    if not is_library(found):
        option = "--native" if native else "--python"
        raise InputError(
            f"{option}: {found} has no folder {kind} beside another kind; leave it out"
        )
    return of_kind(found, kind)


def methods(texts: list[str] | None) -> list[Method] | None:
    """Methods of `--method`; None, which stands for all, where it is not given."""
    from ..studies.precision.method import parse_method

    return [parse_method(text) for text in texts or []] or None


def shows_progress(quiet: bool, as_json: bool) -> bool:
    """Whether a command shows its progress: on a terminal, unless output is for scripts."""
    return sys.stderr.isatty() and not (quiet or as_json)


def overrides(
    laws: str | None = None,
    kind: str | None = None,
    stop: str | None = None,
    step: str | None = None,
    tolerance: float | None = None,
) -> dict[str, dict[str, Any]]:
    """Keys of a scenario that options replace; only those that were given."""
    sized: Any = step
    if step is not None and step.split()[1:] == ["per", "cycle"] and step.split()[0].isdigit():
        sized = {"per_cycle": int(step.split()[0])}
    tables = {
        "master": {"laws": laws, "kind": kind},
        "time": {"stop": stop, "step": sized, "tolerance": tolerance},
    }
    given = {
        name: {key: value for key, value in table.items() if value is not None}
        for name, table in tables.items()
    }
    return {name: table for name, table in given.items() if table}


@contextmanager
def reported() -> Iterator[None]:
    """Show a user's mistake as lines on standard error and an exit code, never a traceback."""
    from ..simulation.interrupt import Interrupted

    try:
        yield
    except (ResilinError, Interrupted) as error:
        fail(str(error), error.exit_code)


def fail(message: str, code: int) -> None:
    """Print each line of a message as an error and leave with an exit code."""
    for line in message.split("\n"):
        typer.echo(f"resilin: {printable(line, most=900)}", err=True)
    raise typer.Exit(code)


def console() -> Console:
    """The terminal for tables; brackets and colons in a text stand as they are."""
    from rich.console import Console

    return Console(markup=False, emoji=False, highlight=False)


def print_json(content: Any) -> None:
    """Print one JSON document; a number that is not finite is null."""
    typer.echo(json.dumps(_finite(content), indent=1))


def _finite(content: Any) -> Any:
    if isinstance(content, dict):
        return {str(key): _finite(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_finite(value) for value in content]
    if isinstance(content, float) and not math.isfinite(content):
        return None
    return content
