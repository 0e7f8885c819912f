"""Build the parts of `fmus/` into FMUs.

    python build_fmus.py                                  every part that has changed, both kinds
    python build_fmus.py linkage --set linkage.stop_travel="1.9 mm" --as linkage_tight
    python build_fmus.py --native                         compiled parts only: no Python in them
    python build_fmus.py ./mine                           a part in a folder of one's own
    python build_fmus.py --recording bench.csv --as bench a measurement as an FMU of its own

Each FMU carries its own copy of the sources it needs as a package named after the FMU and
the digest of those sources, so that two builds of one part can live in one process. The
same digest is the GUID: the same sources give the same GUID, on any machine. A native FMU
carries the same physics as C and as a shared library instead (docs/native.md).
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from fmus.export.archive import Built, put
from fmus.export.build import NATIVE, OUTPUT, build_part, has_compiler, place_of
from fmus.export.new_part import new_part
from fmus.export.outside import is_folder
from fmus.export.sources import BuildError, compilable, load_part, nearest, part_names

__all__ = [
    "NATIVE",
    "OUTPUT",
    "BuildError",
    "Built",
    "build",
    "build_own",
    "compilable",
    "load_part",
    "new_part",
    "part_names",
]


def build(
    name: str,
    *,
    alias: str | None = None,
    changes: dict[str, str] | None = None,
    data: Path | None = None,
    recording: Any = None,
    into: Path | None = None,
    force: bool = False,
    native: bool = False,
    platforms: Iterable[str] = (),
    fmi: int = 2,
) -> Built:
    """Build one part, or reuse the file that was built here of the same sources.

    `name` is that of a part of the package, or a folder with a part of one's own, as `./mine`.
    `alias` names the FMU, `changes` gives start values as texts with units, `data` takes
    the place of the data file that the part's tables are made from, `recording` that of the
    sample that `replay` plays. The rest is as in :func:`fmus.export.build.build_part`. The file is
    noted as built here, so that a master may run it in its own process.
    """
    from orchestrator.fmi.built import digest_of, is_built_here, ledger, note

    part = load_part(name)
    starts = changed_starts(part, changes or {})
    files: dict[str, bytes] = {}
    if data is not None and part.name == "table":
        files, data = tabulated_files(data), None
    if recording is not None:
        starts = recorded_starts(part, recording) | starts
        files = recorded_files(recording)
    target = place_of(alias or part.name, native=native, into=into, fmi=fmi)
    foreign = target.is_file() and not is_built_here(digest_of(target))
    built = build_part(
        part,
        alias=alias,
        starts=starts,
        data=data,
        files=files,
        into=into,
        force=force or foreign,
        native=native,
        platforms=platforms,
        fmi=fmi,
    )
    try:
        note(built.path)
    except OSError as error:
        raise BuildError(
            f"{ledger()}: {built.path} cannot be noted as built here ({error.strerror}); set"
            " XDG_STATE_HOME to a folder that is writable"
        ) from None
    return built


def build_own(
    folder: str,
    *,
    natives: Sequence[bool] = (False, True),
    into: Path | None = None,
    force: bool = False,
    platforms: Iterable[str] = (),
    fmi: int = 2,
) -> list[Built]:
    """Build a part of one's own in each kind, hold each to the reference answer, put all in place.

    Where one of them fails none is put there: an FMU of an older text stays beside its twin of the
    same text. A folder `into` takes one kind. Raises :class:`BuildError` as :func:`build`, and
    where an FMU is further off its reference answer than the part's accuracy.
    """
    if into is not None and len(natives) > 1:
        raise BuildError(f"{into}: takes one kind of FMU, as both have the same name")
    part = load_part(folder)
    if not part.needs:
        _check_rules(part)
    reference = Path(part.physics.__file__).with_name("reference.csv")
    made: list[tuple[Built, Path]] = []
    with tempfile.TemporaryDirectory(prefix="resilin_build_") as waiting:
        for native in natives:
            place = place_of(part.name, native=native, into=into, fmi=fmi)
            own = Path(waiting) / ("compiled" if native else "Python")
            own.mkdir()
            if place.is_file():
                shutil.copyfile(place, own / place.name)
            built = build(
                folder,
                into=own,
                force=force,
                native=native,
                platforms=platforms if native else (),
                fmi=fmi,
            )
            if reference.is_file() and not platforms:
                _check_answer(part, built.path, reference)
            made.append((built, place))
        for built, place in made:
            put(built.path, place)
    return [replace(built, path=place) for built, place in made]


def _check_rules(part: Any) -> None:
    """Translate the physics, so that what the rules do not allow is refused for every kind."""
    from fmus.native.errors import NativeError
    from fmus.native.translate import unit

    try:
        unit.part(part.physics, part.name)
    except NativeError as error:
        raise BuildError(f"{part.name}: {error}") from None


def _check_answer(part: Any, fmu: Path, reference: Path) -> None:
    from orchestrator.errors import ResilinError
    from orchestrator.fmi.reference_answer import reference_deviation

    try:
        found = reference_deviation(fmu, reference)
    except ResilinError as error:
        raise BuildError(str(error)) from None
    if found.error > part.accuracy:
        raise BuildError(
            f"{part.name}, {fmu.parent.name}: {found.variable} = {found.ours:.9g}"
            f" at t = {found.time:g} s, where {reference} has {found.reference:.9g};"
            " no FMU was put in place"
        )


def changed_starts(part: Any, changes: dict[str, str]) -> dict[str, float]:
    """Start values in SI from texts such as `1.9 mm` or `square`, by variable name."""
    settable = {v.name: v for v in part.variables if v.causality == "parameter"}
    values: dict[str, float] = {}
    for name, text in changes.items():
        if name not in settable:
            raise BuildError(f"no parameter {name!r} in {part.name}; {nearest(name, settable)}")
        values[name] = _value(part.name, settable[name], text)
    return values


def _value(part: str, variable: Any, text: str) -> float:
    """One start value; `BuildError` where its text, unit or size does not fit."""
    quantity = variable.quantity
    where = f"{part}.{variable.name} = {text!r}"
    if quantity.choices:
        if text not in quantity.choices:
            raise BuildError(f"{where}: not a choice; {nearest(text, quantity.choices)}")
        return float(quantity.choices.index(text) + 1)
    from orchestrator.units import UnitError, si_value

    try:
        value = si_value(text, quantity.unit)
    except UnitError as error:
        raise BuildError(f"{where}: {error}") from None
    low, high = quantity.least, quantity.most
    if (low is not None and value < low) or (high is not None and value > high):
        raise BuildError(f"{where}: outside {low} to {high} {quantity.unit}")
    return value


def open_recorded(path: Path, name: str, settings: dict[str, str]) -> Any:
    """A recording with the keys that a scenario's component may have, as texts.

    Raises :class:`BuildError` with what is wrong of the keys or of the file.
    """
    from orchestrator.errors import RecordingError, ScenarioError
    from orchestrator.recording.recording import open_recording
    from orchestrator.scenario.parse import scenario_of

    component: dict[str, Any] = {"data": str(path.absolute())}
    for key, text in settings.items():
        table, dot, heading = key.partition(".")
        if dot:
            component.setdefault(table, {})[heading] = text
        else:
            component[key] = {"true": True, "false": False}.get(text, text)
    try:
        scenario = scenario_of({"components": {name: component}}, path)
        return open_recording(scenario.components[name], path)
    except (ScenarioError, RecordingError) as error:
        raise BuildError(str(error).replace(f"{path}: components.{name}.", "--with ")) from None


def recorded_starts(part: Any, recording: Any) -> dict[str, float]:
    """Start values of a replay: its offset, its cycle, and what holds outside of the record."""
    choices = {v.name: v.quantity.choices for v in part.variables}
    starts = {"offset": float(recording.offset), "frequency": float(recording.frequency or 0.0)}
    if not recording.track.period:
        for key in ("before", "after"):
            starts[key] = float(choices[key].index(getattr(recording, key)) + 1)
    return starts


def recorded_files(recording: Any) -> dict[str, bytes]:
    """Sources of a replay that are made from a recording, in SI."""
    import numpy as np

    from fmus.replay.generate import Record, ReplayedOutput, files
    from orchestrator.errors import printable

    track = recording.track
    scales = np.ones(len(track.last))
    outputs = []
    for variable, (how, column, rate) in zip(
        recording.interface.variables.values(), recording.sources, strict=True
    ):
        unit, scale = _in_si(variable.unit)
        if how == "column":
            scales[column] = scale
        outputs.append(
            ReplayedOutput(
                name=variable.name,
                unit=unit,
                meaning=printable(variable.description),
                port=variable.port,
                order=variable.order,
                how=how,
                column=column,
                rate=rate,
            )
        )
    record = Record(
        outputs=outputs,
        knots=track.knots,
        pieces=track.pieces * scales,
        last=track.last * scales,
        first=track.first * scales,
        second=track.second * scales * scales,
        events=recording.events,
        period=track.period,
        grain=track.grain,
    )
    try:
        return files(record)
    except ValueError as error:
        raise BuildError(f"{recording.interface.path}: {error}") from None


def tabulated_files(path: Path) -> dict[str, bytes]:
    """Sources of a table that are made from a file of points, in SI."""
    import numpy as np

    from fmus.table.generate import Column, files, relation
    from orchestrator.errors import RecordingError
    from orchestrator.recording.columns import Choice
    from orchestrator.recording.read import read_table

    try:
        table = read_table(path, Choice(interval=1.0))
    except RecordingError as error:
        raise BuildError(str(error)) from None
    columns = table.columns[1:]
    units = [_in_si(column.unit) for column in columns]
    named = [Column(c.name, unit) for c, (unit, _) in zip(columns, units, strict=True)]
    rows = table.values * np.array([scale for _, scale in units])
    try:
        return files(relation(named, rows))
    except ValueError as error:
        raise BuildError(f"{path}: {error}") from None


def _in_si(unit: str) -> tuple[str, float]:
    """Unit in SI as FMI writes it, and how many of it one is; "" stays unsaid."""
    from fmus.units import exponents
    from orchestrator.units import UnitError, in_base

    if not unit:
        return "", 1.0
    try:
        exponents(unit)
        return unit, 1.0
    except ValueError:
        pass
    try:
        return in_base(unit)
    except UnitError as error:
        raise BuildError(str(error)) from None


def _assignments(texts: list[str], parts: list[str]) -> dict[str, dict[str, str]]:
    """`part.parameter=value` texts, by part."""
    changes: dict[str, dict[str, str]] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        part, dot, parameter = name.strip().partition(".")
        if not (equals and dot):
            raise BuildError(f"--set {text!r}: write part.parameter=value")
        if part not in parts:
            raise BuildError(f"--set {text!r}: no part {part!r} here; {nearest(part, parts)}")
        changes.setdefault(part, {})[parameter] = value.strip()
    return changes


def _replayed(
    parts: list[str] | None,
    path: Path,
    alias: str | None,
    texts: list[str] | None,
    keys: list[str] | None,
) -> tuple[list[str], Any, None]:
    """What `--recording` asks for: the part, the recording that it is to play, no changes."""
    if parts and parts != ["replay"]:
        raise BuildError(f"--recording makes a replay: leave out {', '.join(parts)}")
    if not alias:
        raise BuildError("--recording makes an FMU of its own: name it with --as")
    if texts:
        raise BuildError(f"--set {texts[0]!r}: keys of a recording are given as --with key=value")
    settings = {}
    for text in keys or []:
        key, equals, value = text.rpartition("=")
        if not (equals and key.strip()):
            raise BuildError(f"--with {text!r}: write key=value")
        settings[key.strip()] = value.strip()
    return ["replay"], open_recorded(path, alias, settings), None


def build_command(
    parts: Annotated[
        list[str] | None,
        typer.Argument(help="Parts to build, or folders of one's own, as ./mine; all if none."),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help="Start value, as linkage.stop_travel=1.9mm; may repeat."),
    ] = None,
    alias: Annotated[
        str | None, typer.Option("--as", help="Name of the FMU; needs exactly one part.")
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(help="Data file in the place of the part's own, as films for membrane."),
    ] = None,
    recording: Annotated[
        Path | None,
        typer.Option(help="Recording to make an FMU of."),
    ] = None,
    keys: Annotated[
        list[str] | None,
        typer.Option("--with", help="Key of a recording, as interpolation=linear; may repeat."),
    ] = None,
    into: Annotated[
        Path | None, typer.Option(help="Folder for the FMUs; build/fmus or build/native.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Build unchanged parts too.")] = False,
    native: Annotated[
        bool | None,
        typer.Option(
            "--native/--python",
            help="Compiled FMUs only, or Python FMUs only; both where there is a C compiler.",
        ),
    ] = None,
    platform: Annotated[
        list[str] | None,
        typer.Option(help="Platform of a native FMU: linux64, win64, darwin64; may repeat."),
    ] = None,
    fmi: Annotated[
        int,
        typer.Option(min=2, max=3, help="Version of FMI; 3 with --native, into build/fmi3."),
    ] = 2,
) -> None:
    """Build parts into FMUs; unchanged ones are left as they are.

    \b
    Example: resilin build linkage --set linkage.stop_travel="1.9 mm" --as linkage_tight
    """
    from rich.console import Console
    from rich.table import Table

    try:
        record = None
        if keys and recording is None:
            raise BuildError("--with gives keys of a recording: name that by --recording")
        if recording is not None:
            parts, record, set_ = _replayed(parts, recording, alias, set_, keys)
        wanted = {
            name: load_part(name) for name in parts or (compilable() if native else part_names())
        }
        changes = _assignments(set_ or [], [part.name for part in wanted.values()])
        if alias and len(wanted) != 1:
            raise BuildError("--as names one FMU: give exactly one part")
        if (changes or data) and not alias:
            raise BuildError("--set and --data make a variant: name it with --as")
        kinds = _kinds(native, into)
        done: list[tuple[str, Built]] = []
        for name, part in wanted.items():
            mine = [kind for kind in kinds if kind == "Python" or native or not part.needs]
            if is_folder(name) and not (alias or changes or data):
                natives = [kind == "compiled" for kind in mine]
                found = build_own(
                    name,
                    natives=natives,
                    into=into,
                    force=force,
                    platforms=platform or (),
                    fmi=fmi,
                )
            else:
                found = [
                    build(
                        name,
                        alias=alias,
                        changes=changes.get(part.name),
                        data=data,
                        recording=record,
                        into=into,
                        force=force,
                        native=kind == "compiled",
                        platforms=platform or (),
                        fmi=fmi,
                    )
                    for kind in mine
                ]
            done += zip(mine, found, strict=True)
    except (BuildError, OSError) as error:
        for line in str(error).splitlines():
            typer.echo(f"build: {line}", err=True)
        raise typer.Exit(2) from None
    table = Table("part", "kind", "variables", "size", "digest", "")
    for kind, fmu in sorted(done, key=lambda each: each[0] == "compiled"):
        state = "built" if fmu.fresh else "unchanged"
        kilobytes = f"{fmu.size / 1024:.0f} KiB"
        table.add_row(fmu.name, kind, str(fmu.variables), kilobytes, fmu.guid[:8], state)
    Console().print(table)
    if native is None and into is None and len(kinds) == 1:
        typer.echo(
            "no C compiler was found: only Python FMUs were built, which run slower; install cc, or"
            " pip install 'resilin[native]'"
        )


def builder() -> typer.Typer:
    """The command alone; its help keeps paragraphs and the example whole."""
    made = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
    made.command()(build_command)
    return made


def _kinds(native: bool | None, into: Path | None) -> list[str]:
    """Kinds of FMU to build: one where it or its folder is named, both where both can be."""
    if native is not None:
        return ["compiled" if native else "Python"]
    return ["Python", "compiled"] if into is None and has_compiler() else ["Python"]


if __name__ == "__main__":
    builder()()
