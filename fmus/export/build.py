"""One part as an FMU, of Python or compiled: made anew where its sources have changed."""

from __future__ import annotations

import tempfile
import uuid
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..units import exponents
from .archive import Built, described, guid_in, problems_of, put, seal
from .documentation import documentation_of
from .sources import BuildError, digest_of, nearest, source_files
from .staging import compiled, export, stage

OUTPUT = Path("build") / "fmus"
NATIVE = Path("build") / "native"
NATIVE_FMI3 = Path("build") / "fmi3"


def native_exporter(part: Any, platforms: list[str], fmi: int) -> list[str]:
    """What identifies the native build beside the sources; `BuildError` where there is none."""
    if part.needs:
        raise BuildError(
            f"{part.name} needs {', '.join(part.needs)} when it runs: it cannot be built without"
            " Python; leave out --native"
        )
    from ..native.errors import NativeError
    from ..native.link import checked
    from ..native.package import marks

    try:
        return marks(checked(platforms), fmi)
    except NativeError as error:
        raise BuildError(f"--platform: {error}") from None


def has_compiler() -> bool:
    """Whether parts can be compiled here."""
    from ..native.errors import NativeError
    from ..native.link import PLATFORMS, compiler, own_platform

    try:
        compiler(PLATFORMS[own_platform()].targets[0], own=True)
    except (NativeError, KeyError):
        return False
    return True


def place_of(title: str, *, native: bool, into: Path | None, fmi: int = 2) -> Path:
    """Where an FMU of this name goes."""
    compiled_ones = NATIVE_FMI3 if fmi == 3 else NATIVE
    return (into or (compiled_ones if native else OUTPUT)) / f"{title}.fmu"


def build_part(
    part: Any,
    *,
    alias: str | None = None,
    starts: dict[str, float] | None = None,
    data: Path | None = None,
    files: dict[str, bytes] | None = None,
    into: Path | None = None,
    force: bool = False,
    native: bool = False,
    platforms: Iterable[str] = (),
    fmi: int = 2,
) -> Built:
    """Build a part, or reuse the file that stands for the same sources.

    `alias` names the FMU; `starts` are start values in SI that differ from the part's; `data`
    takes the place of the data file that the part's tables are made from, `files` of others of its
    files. `native` compiles the part, for `platforms` or for this machine's, for version 2 or 3 of
    FMI. The file appears whole or not at all, and only if fmpy's validation finds no problem.
    Raises :class:`BuildError`.
    """
    from importlib.metadata import version

    wanted = list(platforms)
    if wanted and not native:
        raise BuildError("--platform goes with --native: the Python FMUs run on every platform")
    if fmi == 3 and not native:
        raise BuildError("--fmi 3 goes with --native: the Python FMUs are of FMI 2.0")
    exporter = native_exporter(part, wanted, fmi) if native else [version("pythonfmu")]
    documentation = documentation_of(part)
    exporter.append(documentation.digest)
    title = alias or part.name
    if not title.isidentifier():
        raise BuildError(f"{title!r} cannot name an FMU: use letters, digits and underscores")
    target = place_of(title, native=native, into=into, fmi=fmi)
    check_description(part)
    starts = starts or {}
    sources = _sources(part, data) | (files or {})
    alike = digest_of(title, sources, starts, [])
    digest = digest_of(title, sources, starts, exporter)
    guid = str(uuid.UUID(digest[:32]))
    if not force and guid_in(target) == guid:
        return described(title, target, guid, fresh=False)
    for path, (origin, make) in part.generated.items():
        try:
            sources[path] = make(sources[origin].decode()).encode()
        except ValueError as error:
            raise BuildError(f"{title}: {origin}: {error}") from None
    with tempfile.TemporaryDirectory(prefix="resilin_build_") as folder:
        staged = stage(Path(folder), title, part, sources, starts, digest, guid, alike)
        if native:
            raw = compiled(
                staged, title, part, guid, alike, starts, wanted, fmi, icon=documentation.has_icon
            )
        else:
            raw = export(staged, Path(folder) / "raw")
        sealed = Path(folder) / f"{title}.fmu"
        seal(raw, sealed, documentation.files(fmi))
        problems = problems_of(sealed)
        if problems:
            raise BuildError(f"{title}: {problems[0]}")
        put(sealed, target)
    return described(title, target, guid, fresh=True)


def check_description(part: Any) -> None:
    """`BuildError` where a variable has no unit of ours, or depends on what is no input or port."""
    inputs = [v for v in part.variables if v.causality == "input"]
    known = {v.name for v in inputs} | {v.quantity.port for v in inputs} - {""}
    for v in part.variables:
        if not v.quantity.choices and v.quantity.unit:
            try:
                exponents(v.quantity.unit)
            except ValueError as error:
                raise BuildError(f"{part.name}: {v.name}: {error}") from None
        for name in v.quantity.depends:
            if name not in known:
                hint = nearest(name, known) if known else "the part has no inputs"
                raise BuildError(f"{part.name}: {v.name}: depends on no input {name!r}; {hint}")


def _sources(part: Any, data: Path | None) -> dict[str, bytes]:
    """The texts that the FMU is made of, with another data file where one is given."""
    files = source_files(part)
    if data is None:
        return files
    if not part.generated:
        raise BuildError(f"{part.name} has no data file to replace")
    try:
        text = data.read_bytes()
        text.decode()
    except (OSError, UnicodeDecodeError) as error:
        raise BuildError(f"{data}: cannot be read as UTF-8 text ({error})") from None
    return files | {origin: text for origin, _ in part.generated.values()}
