"""Build the parts of `fmus/` into FMUs.

    python build_fmus.py                                  every part, if it has changed
    python build_fmus.py linkage --set linkage.stop_travel="1.9 mm" --as linkage_tight
    python build_fmus.py --native                         the same parts without Python in them
    python build_fmus.py --recording bench.csv --as bench a measurement as an FMU of its own

Each FMU carries its own copy of the sources it needs as a package named after the FMU and
the digest of those sources, so that two builds of one part can live in one process. The
same digest is the GUID: the same sources give the same GUID, on any machine. A native FMU
carries the same physics as C and as a shared library instead (docs/native.md).
"""

from __future__ import annotations

import difflib
import hashlib
import importlib
import importlib.util
import json
import shutil
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

HERE = Path(__file__).resolve().parent
SOURCES = HERE / "fmus"
OUTPUT = Path("build") / "fmus"
NATIVE = Path("build") / "native"
EPOCH = (1980, 1, 1, 0, 0, 0)


class BuildError(Exception):
    """What keeps an FMU from being built: names the part or parameter, and the way out."""


@dataclass(frozen=True)
class Built:
    """One FMU on disk."""

    name: str
    path: Path
    variables: int
    size: int
    guid: str
    fresh: bool


def part_names() -> list[str]:
    """Parts that can be built: the folders of `fmus/` that have a slave."""
    return sorted(path.parent.name for path in SOURCES.glob("*/slave.py"))


def nearest(word: str, words: Iterable[str]) -> str:
    """`; did you mean X?`, or the list of what there is."""
    choices = sorted(words)
    close = difflib.get_close_matches(word, choices, n=1)
    return f"did you mean {close[0]!r}?" if close else f"there is {', '.join(choices)}"


def load_part(name: str) -> Any:
    """The `PART` of a folder; `BuildError` if there is no such part."""
    names = part_names()
    if name not in names:
        raise BuildError(f"no part {name!r}; {nearest(name, names)}")
    return importlib.import_module(f"fmus.{name}.slave").PART


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


def source_files(part: Any) -> dict[str, bytes]:
    """Path inside the FMU's package -> text, for all that the part is made of."""
    folders = [SOURCES, SOURCES / part.name, *(SOURCES / name for name in part.includes)]
    files: dict[str, bytes] = {}
    for folder in folders:
        for path in sorted(folder.iterdir()):
            if path.suffix in {".py", ".json", ".toml"} and path.is_file():
                files[path.relative_to(SOURCES).as_posix()] = path.read_bytes()
    return files


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
        raise BuildError(str(error).replace(f"{path}: components.{name}.", "--set ")) from None


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


def digest_of(
    name: str, files: dict[str, bytes], starts: dict[str, float], exporter: list[str]
) -> str:
    """SHA-256 over name, sources, changed starts and what tells the exporter."""
    digest = hashlib.sha256()
    head = [name, *exporter, sorted(starts.items())]
    digest.update(json.dumps(head).encode())
    for path, text in sorted(files.items()):
        digest.update(path.encode() + b"\0" + text + b"\0")
    return digest.hexdigest()


def native_exporter(part: Any, platforms: list[str]) -> list[str]:
    """What identifies the native build beside the sources; `BuildError` where there is none."""
    if part.needs:
        raise BuildError(
            f"{part.name} needs {', '.join(part.needs)} when it runs: it cannot be built without"
            " Python; leave out --native"
        )
    from fmus.native.errors import NativeError
    from fmus.native.link import checked
    from fmus.native.package import marks

    try:
        return marks(checked(platforms))
    except NativeError as error:
        raise BuildError(f"--platform: {error}") from None


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
) -> Built:
    """Build one part, or reuse the file that stands for the same sources.

    `alias` names the FMU, `changes` gives start values as texts with units, `data` takes
    the place of the data file that the part's tables are made from, `recording` that of the
    sample that `replay` plays. `native` compiles the part, for `platforms` or for this machine's.
    The file appears whole or not at all, and only if fmpy finds nothing to complain about.
    """
    from importlib.metadata import version

    part = load_part(name)
    into = into or (NATIVE if native else OUTPUT)
    wanted = list(platforms)
    if wanted and not native:
        raise BuildError("--platform goes with --native: the Python FMUs run on every platform")
    if native:
        exporter = native_exporter(part, wanted)
    else:
        exporter = [version("pythonfmu")]
    title = alias or name
    if not title.isidentifier():
        raise BuildError(f"{title!r} cannot name an FMU: use letters, digits and underscores")
    starts, files = _sources(part, changes or {}, data, recording)
    digest = digest_of(title, files, starts, exporter)
    guid = str(uuid.UUID(digest[:32]))
    target = into / f"{title}.fmu"
    if not force and _guid_in(target) == guid:
        return _described(title, target, guid, fresh=False)
    for path, (origin, make) in part.generated.items():
        try:
            files[path] = make(files[origin].decode()).encode()
        except ValueError as error:
            raise BuildError(f"{title}: {origin}: {error}") from None
    with tempfile.TemporaryDirectory(prefix="resilin_build_") as folder:
        staged = _stage(Path(folder), title, part, files, starts, digest, guid)
        if native:
            raw = _compile(staged, title, part, guid, starts, wanted)
        else:
            raw = _export(staged, Path(folder) / "raw")
        sealed = Path(folder) / f"{title}.fmu"
        _seal(raw, sealed)
        problems = _problems(sealed)
        if problems:
            raise BuildError(f"{title}: {problems[0]}")
        into.mkdir(parents=True, exist_ok=True)
        partial = into / f".{title}.fmu.part"
        shutil.copyfile(sealed, partial)
        partial.replace(target)
    return _described(title, target, guid, fresh=True)


def _sources(
    part: Any, changes: dict[str, str], data: Path | None, recording: Any
) -> tuple[dict[str, float], dict[str, bytes]]:
    """Start values that differ from the part's, and the texts that the FMU is made of."""
    starts = changed_starts(part, changes)
    files = source_files(part)
    if data is not None:
        if not part.generated:
            raise BuildError(f"{part.name} has no data file to replace")
        try:
            text = data.read_bytes()
            text.decode()
        except (OSError, UnicodeDecodeError) as error:
            raise BuildError(f"{data}: cannot be read as UTF-8 text ({error})") from None
        files.update({origin: text for origin, _ in part.generated.values()})
    if recording is not None:
        starts = recorded_starts(part, recording) | starts
        files.update(recorded_files(recording))
    return starts, files


def _stage(
    folder: Path,
    title: str,
    part: Any,
    files: dict[str, bytes],
    starts: dict[str, float],
    digest: str,
    guid: str,
) -> Path:
    """Write the package and the entry script; return the script.

    The exporter drops one reference too many to the script's namespace, so the script
    pins itself; and it must not define the class, which lives in the package.
    """
    from fmus import __version__

    package = f"{title}_{digest[:8]}"
    for path, text in files.items():
        target = folder / package / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text)
    slave = importlib.import_module(f"fmus.{part.name}.slave")
    base = next(key for key, value in vars(slave).items() if getattr(value, "part", None) is part)
    entry = (
        '"""The class behind this FMU."""\n\n'
        f"from .{part.name}.slave import {base}\n\n\n"
        f"class {title}({base}):\n"
        f'    """{part.description}."""\n\n'
        f"    digest = {guid!r}\n"
        f"    release = {__version__!r}\n"
        f"    changes = {starts!r}\n"
    )
    (folder / package / "entry.py").write_text(entry, encoding="utf-8")
    script = folder / f"{package}_script.py"
    script.write_text(
        f"from {package}.entry import {title}\n"
        'globals().setdefault("_pins", []).append(globals())\n',
        encoding="utf-8",
    )
    return script


def _export(script: Path, into: Path) -> Path:
    """Run the exporter on a staged script.

    An FMU that this process has loaded brings an exporter of its own, without the libraries:
    the one that is installed is put in its place for as long.
    """
    from importlib.metadata import distribution

    with _importable(script) as package:
        carried = _taken_out("pythonfmu")
        sys.path.insert(0, str(distribution("pythonfmu").locate_file("")))
        try:
            builder = importlib.import_module("pythonfmu").FmuBuilder
            return Path(builder.build_FMU(script, dest=into, project_files={package}))
        finally:
            _taken_out("pythonfmu")
            sys.modules.update(carried)


def _compile(
    script: Path,
    title: str,
    part: Any,
    guid: str,
    starts: dict[str, float],
    platforms: list[str],
) -> Path:
    """Compile the physics of a staged package, which has its own tables."""
    from fmus import __version__
    from fmus.native.errors import NativeError
    from fmus.native.link import checked
    from fmus.native.package import packed

    into = script.parent / "raw"
    into.mkdir()
    with _importable(script) as package:
        own = importlib.import_module(f"{package.name}.{part.name}.slave").PART
        try:
            return packed(own, title, guid, __version__, starts, checked(platforms), into)
        except NativeError as error:
            raise BuildError(f"{title}: {error}") from None


@contextmanager
def _importable(script: Path) -> Iterator[Path]:
    """The staged package beside a script, importable; then what `sys` held before."""
    importlib.invalidate_caches()
    package = script.with_name(script.stem.removesuffix("_script"))
    before = list(sys.path)
    loaded = _taken_out(package.name)
    sys.path.insert(0, str(script.parent))
    cached, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield package
    finally:
        sys.path[:] = before
        sys.dont_write_bytecode = cached
        _taken_out(package.name)
        sys.modules.update(loaded)


def _taken_out(package: str) -> dict[str, Any]:
    """Modules of a package, removed from `sys.modules`: a loaded FMU may have the same ones."""
    names = [name for name in sys.modules if name.split(".")[0].startswith(package)]
    return {name: sys.modules.pop(name) for name in names}


def _seal(raw: Path, sealed: Path) -> None:
    """Copy an archive with sorted entries, fixed dates and compression."""
    with (
        zipfile.ZipFile(raw) as source,
        zipfile.ZipFile(sealed, "w", zipfile.ZIP_DEFLATED) as target,
    ):
        for name in sorted(source.namelist()):
            info = zipfile.ZipInfo(name, EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            text = source.read(name)
            if name == "modelDescription.xml":
                text = b"\n".join(line for line in text.splitlines() if line.strip()) + b"\n"
            target.writestr(info, text)


def _problems(path: Path) -> list[str]:
    """What fmpy's validation finds, and whether there is anything to run."""
    from fmpy.validation import validate_fmu

    problems = [str(problem) for problem in validate_fmu(str(path))]
    with zipfile.ZipFile(path) as archive:
        if not any(name.startswith("binaries/") for name in archive.namelist()):
            problems.append("the exporter left out its libraries: install pythonfmu again")
    return problems


def _guid_in(path: Path) -> str:
    """GUID of a built file; empty where there is none to read."""
    from xml.etree import ElementTree

    try:
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError):
        return ""
    return root.get("guid", "")


def _described(name: str, path: Path, guid: str, *, fresh: bool) -> Built:
    """Entry of the table for a file on disk."""
    from xml.etree import ElementTree

    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    variables = len(root.findall("ModelVariables/ScalarVariable"))
    return Built(name, path, variables, path.stat().st_size, guid, fresh)


def compilable() -> list[str]:
    """Parts that have a native form: those that need no package when they run."""
    return [name for name in part_names() if not load_part(name).needs]


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
    parts: list[str] | None, path: Path, alias: str | None, texts: list[str] | None
) -> tuple[list[str], Any, None]:
    """What `--recording` asks for: the part, the recording that it is to play, no changes."""
    if parts and parts != ["replay"]:
        raise BuildError(f"--recording makes a replay: leave out {', '.join(parts)}")
    if not alias:
        raise BuildError("--recording makes an FMU of its own: name it with --as")
    settings = _assignments(texts or [], [alias]).get(alias, {})
    return ["replay"], open_recorded(path, alias, settings), None


def build_command(
    parts: Annotated[list[str] | None, typer.Argument(help="Parts to build; all if none.")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help='Start value, as linkage.stop_travel="1.9 mm".'),
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
        typer.Option(
            help="Recording to make an FMU of; --set NAME.key=value takes the keys of a scenario."
        ),
    ] = None,
    into: Annotated[
        Path | None, typer.Option(help="Folder for the FMUs; build/fmus or build/native.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Build unchanged parts too.")] = False,
    native: Annotated[
        bool, typer.Option("--native", help="Compile the parts: FMUs without Python in them.")
    ] = False,
    platform: Annotated[
        list[str] | None,
        typer.Option(help="Platform of a native FMU: linux64, win64, darwin64; may repeat."),
    ] = None,
) -> None:
    """Build parts into FMUs; unchanged ones are left as they are.

    Example: build linkage --set linkage.stop_travel="1.9 mm" --as linkage_tight
    """
    from rich.console import Console
    from rich.table import Table

    try:
        record = None
        if recording is not None:
            parts, record, set_ = _replayed(parts, recording, alias, set_)
        wanted = list(parts or (compilable() if native else part_names()))
        changes = _assignments(set_ or [], wanted)
        if alias and len(wanted) != 1:
            raise BuildError("--as names one FMU: give exactly one part")
        if (changes or data) and not alias:
            raise BuildError("--set and --data make a variant: name it with --as")
        done = [
            build(
                name,
                alias=alias,
                changes=changes.get(name),
                data=data,
                recording=record,
                into=into,
                force=force,
                native=native,
                platforms=platform or (),
            )
            for name in wanted
        ]
    except (BuildError, OSError) as error:
        for line in str(error).splitlines():
            typer.echo(f"build: {line}", err=True)
        raise typer.Exit(2) from None
    table = Table("part", "variables", "size", "digest", "")
    for fmu in done:
        state = "built" if fmu.fresh else "unchanged"
        kilobytes = f"{fmu.size / 1024:.0f} KiB"
        table.add_row(fmu.name, str(fmu.variables), kilobytes, fmu.guid[:8], state)
    Console().print(table)


if __name__ == "__main__":
    typer.run(build_command)
