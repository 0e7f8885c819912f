"""Where built parts are found: the Python FMU of a part, or its compiled twin."""

from __future__ import annotations

import functools
import os
import re
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from ..errors import nearest
from .files import is_file

LIBRARY = Path("build")
"""What `resilin build` fills: `fmus` with the Python FMUs, `native` with the compiled ones.

Given as the folder of the parts it stands for the nearest that have them, see :func:`located`.
"""
PYTHON = "fmus"
NATIVE = "native"
CHECKOUT = Path(__file__).absolute().parents[2]
SOURCES = re.compile(rb"<Sources digest=\"([0-9a-f]{64})\"")


def located(library: Path, scenario: Path | None = None) -> Path:
    """The folder of the built parts: as given, or every `build` that holds any, nearest first.

    They are looked for in the current folder and those above it, in the scenario's and those above
    that, and in the checkout that this package runs from; several are one path, see
    :func:`folders`. Where there is none, it is `build` here.
    """
    if library != LIBRARY:
        return library
    found: dict[Path, Path] = {}
    with suppress(OSError):
        for folder in _searched(scenario):
            if folder.absolute() not in found and _holds_parts(folder / LIBRARY):
                found[folder.absolute()] = folder / LIBRARY
    return _joined(found.values()) if found else library


def folders(library: Path) -> list[Path]:
    """The folders that a path of parts names, as PATH does: a part is taken from the first of them
    that has it."""
    if os.pathsep not in str(library) or library.is_dir():
        return [library]
    return [Path(text) for text in str(library).split(os.pathsep)]


def of_kind(library: Path, kind: str) -> Path:
    """The parts of one kind in a library of both."""
    return _joined(folder / kind for folder in folders(library) if is_library(folder))


def _joined(found: Iterable[Path]) -> Path:
    return Path(os.pathsep.join(map(str, found)))


def _searched(scenario: Path | None) -> Iterator[Path]:
    yield Path()
    yield from Path.cwd().parents
    if scenario is not None:
        yield from scenario.absolute().parents
    if _in_checkout():
        yield CHECKOUT


def _in_checkout() -> bool:
    return (CHECKOUT / "build_fmus.py").is_file() and (CHECKOUT / "pyproject.toml").is_file()


def _holds_parts(library: Path) -> bool:
    return any(any((library / kind).glob("*.fmu")) for kind in (PYTHON, NATIVE))


def built_part(name: str, library: Path) -> Path:
    """File of a part in the first folder that has it, of FMUs or a library of both kinds.

    Of a library the compiled FMU is taken where it is made of the same sources and start values as
    the Python FMU, or where there is no other; the Python FMU else. A stale twin is left alone.
    """
    files = [_file_in(folder, name) for folder in folders(library)]
    return next((file for file in files if is_file(file)), files[0])


def _file_in(folder: Path, name: str) -> Path:
    plain = folder / f"{name}.fmu"
    if is_file(plain) or not is_library(folder):
        return plain
    python, native = folder / PYTHON / plain.name, folder / NATIVE / plain.name
    if is_file(native) and (not is_file(python) or _alike(python, native)):
        return native
    return python


def part_names(library: Path) -> list[str]:
    """Names of the built parts in folders of FMUs, or in libraries of both kinds."""
    found = [
        part
        for folder in folders(library)
        for part in ([folder / PYTHON, folder / NATIVE] if is_library(folder) else [folder])
    ]
    return sorted({path.stem for folder in found for path in folder.glob("*.fmu")})


def is_library(library: Path) -> bool:
    """Whether a folder, or one of several, holds both kinds of FMU in folders of their own."""
    return any(
        folder == LIBRARY or (folder / PYTHON).is_dir() or (folder / NATIVE).is_dir()
        for folder in folders(library)
    )


def missing_part(name: str, library: Path, scenario: Path | None = None) -> str:
    """What to say where a part has not been built."""
    built = part_names(library)
    command = "resilin build --native" if library.name == NATIVE else "resilin build"
    if not built and library in {LIBRARY, LIBRARY / PYTHON, LIBRARY / NATIVE}:
        return f"no part {name!r}: {nothing_built(command, scenario)}"
    places = ", ".join(map(str, folders(library)))
    if not built:
        return f"no part {name!r} in {places}, which holds no FMU; run: {command}"
    return f"no part {name!r} in {places}; {nearest(name, built)} ({command} makes parts)"


def nothing_built(command: str = "resilin build", scenario: Path | None = None) -> str:
    """Where built parts were looked for in vain, and the way out."""
    folders = [Path.cwd()] + ([] if scenario is None else [scenario.absolute().parent])
    places = [f"{folder} and above" for folder in dict.fromkeys(folders)]
    if _in_checkout() and not any(CHECKOUT in (folder, *folder.parents) for folder in folders):
        places.append(str(CHECKOUT))
    return (
        f"no folder build/ with FMUs in {', in '.join(places)};"
        f" run: {command}, or name another folder: --fmus"
    )


def _alike(one: Path, other: Path) -> bool:
    digests = [_sources(path, path.stat().st_mtime_ns) for path in (one, other)]
    return digests[0] == digests[1] != b""


@functools.lru_cache(maxsize=256)
def _sources(path: Path, changed: int) -> bytes:
    """Digest of the sources that an FMU of ours is made of; empty where it has none."""
    del changed
    try:
        with zipfile.ZipFile(path) as archive, archive.open("modelDescription.xml") as file:
            found = SOURCES.search(file.read(1 << 20))
    except (OSError, KeyError, zipfile.BadZipFile, RuntimeError):
        return b""
    return found[1] if found else b""
