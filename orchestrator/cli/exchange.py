"""`resilin schema`, `resilin export`: scenarios for editors and for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import common
from .command_list import SCENARIOS
from .renamed_options import known_as

if TYPE_CHECKING:
    from ..scenario.plan import Plan


def add_to(app: typer.Typer) -> None:
    """Register the commands."""
    app.command(
        "export", rich_help_panel=SCENARIOS, cls=known_as(to="output", also="parameter_set")
    )(export)
    app.command("schema", rich_help_panel=SCENARIOS)(schema)


def export(
    scenario: common.ScenarioName,
    output: Annotated[
        Path | None, typer.Option(help="SSP archive; SCENARIO.ssp if not given.")
    ] = None,
    parameter_set: Annotated[
        list[str] | None,
        typer.Option(help="Further parameter set, as heavy:payload.mass=2g; may repeat."),
    ] = None,
    version: Annotated[str, typer.Option("--ssp", help="Version of SSP, 1.0 or 2.0.")] = "1.0",
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    stop: common.Stop = None,
    step: common.Step = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    quiet: common.Quiet = False,
) -> None:
    """Write a scenario as an SSP archive for other tools.

    It holds structure, parameters and FMUs.

    \b
    Example: resilin export flapping-full-wings --output vehicle.ssp --native
    """
    from ..errors import InputError
    from ..report.files import check_place
    from ..scenario.ssp.write import VERSIONS, Package, write_ssp
    from ..simulation.load import unloaded
    from ..simulation.scratch import Scratch

    target = output or Path(f"{Path(scenario).stem}.ssp")
    with common.reported(), Scratch(Path(scenario)) as folder:
        check_place(target, "is no SSP archive by its name", [".ssp"])
        if version not in VERSIONS:
            raise InputError(f"--ssp {version}: is not written; choose {' or '.join(VERSIONS)}")
        options = common.overrides(laws, kind, stop, step)
        library = common.library(fmus, native, scenario)
        plan = unloaded(scenario, common.assignments(set_), library, **options)
        sets = _sets(scenario, parameter_set or [], library, options)
        files, built_in = _made(plan, folder)
        remarks = write_ssp(Package(plan, files, built_in, sets, version), target)
    if not quiet:
        for remark in remarks:
            typer.echo(f"remark: {remark}")
        typer.echo(f"{len(plan.interfaces)} components, {len(plan.connections)} wires: {target}")


def _made(plan: Plan, folder: Path) -> tuple[dict[str, Path], frozenset[str]]:
    """FMUs built for an archive: recordings, and parts that start with the scenario's choices.

    An archive cannot hold a recording as it is, and other tools do not read choices from it.
    """
    from ..errors import ScenarioError

    if not (plan.recordings or any(_choices(plan, name) for name in plan.interfaces)):
        return {}, frozenset()
    try:
        import build_fmus
    except ImportError:
        raise ScenarioError(
            "FMUs for the archive cannot be built without build_fmus.py; export from a checkout"
        ) from None
    files: dict[str, Path] = {}
    built_in: set[str] = set()
    try:
        for name, recording in plan.recordings.items():
            built = build_fmus.build("replay", alias=name, recording=recording, into=folder)
            files[name] = built.path
        for name, interface in plan.interfaces.items():
            choices = _choices(plan, name)
            if not choices or interface.path.stem not in build_fmus.part_names():
                continue
            alias = "_".join([interface.path.stem, *choices.values()])
            native = not interface.needs_tool
            built = build_fmus.build(
                interface.path.stem, alias=alias, changes=choices, into=folder, native=native
            )
            files[name] = built.path
            built_in |= {f"{name}.{key}" for key in choices}
    except build_fmus.BuildError as error:
        raise ScenarioError(str(error)) from None
    return files, frozenset(built_in)


def _choices(plan: Plan, name: str) -> dict[str, str]:
    """Choices of a scenario that differ from those of our own part, by parameter."""
    interface = plan.interfaces[name]
    found = {}
    for key, value in plan.starts.get(name, {}).items():
        variable = interface.variables[key]
        if interface.ours and variable.choices and variable.start != value:
            found[key] = variable.choices[variable.codes.index(int(value))]
    return found


def _sets(
    scenario: str, texts: list[str], library: Path, options: dict[str, dict[str, object]]
) -> dict[str, dict[str, float | str]]:
    """Parameter sets of `NAME:component.parameter=value` texts, in the FMUs' units."""
    from ..errors import InputError
    from ..simulation.load import unloaded

    wanted: dict[str, dict[str, str]] = {}
    for text in texts:
        name, colon, assignment = text.partition(":")
        if not (colon and name.isidentifier()) or name in {"parameters", "SystemStructure"}:
            raise InputError(f"--parameter-set {text!r}: write NAME:component.parameter=value")
        wanted.setdefault(name, {}).update(common.assignments([assignment], "--parameter-set"))
    made: dict[str, dict[str, float | str]] = {}
    for name, changes in wanted.items():
        starts = unloaded(scenario, changes, library, **options).starts
        made[name] = {key: starts[key.partition(".")[0]][key.partition(".")[2]] for key in changes}
    return made


def schema() -> None:
    """Print the JSON Schema of scenario files, for editors.

    It is for completion and checks.

    \b
    Example: resilin schema > scenario.schema.json
    """
    from ..scenario.schema import json_schema

    common.print_json(json_schema())
