"""Where built parts are found: the Python FMU of a part, or its compiled twin."""

from __future__ import annotations

import functools
import re
import zipfile
from pathlib import Path

from ..errors import nearest
from .files import is_file

LIBRARY = Path("build")
"""What `resilin build` fills: `fmus` with the Python FMUs, `native` with the compiled ones."""
PYTHON = "fmus"
NATIVE = "native"
SOURCES = re.compile(rb"<Sources digest=\"([0-9a-f]{64})\"")


def built_part(name: str, library: Path) -> Path:
    """File of a part in a folder of FMUs, or in a library of both kinds.

    Of a library the compiled FMU is taken where it is made of the same sources and start values as
    the Python FMU, or where there is no other; the Python FMU else. A stale twin is left alone.
    """
    plain = library / f"{name}.fmu"
    if is_file(plain) or not is_library(library):
        return plain
    python, native = library / PYTHON / plain.name, library / NATIVE / plain.name
    if is_file(native) and (not is_file(python) or _alike(python, native)):
        return native
    return python


def part_names(library: Path) -> list[str]:
    """Names of the built parts in a folder of FMUs, or in a library of both kinds."""
    folders = [library / PYTHON, library / NATIVE] if is_library(library) else [library]
    return sorted({path.stem for folder in folders for path in folder.glob("*.fmu")})


def is_library(folder: Path) -> bool:
    """Whether a folder holds both kinds of FMU in folders of their own."""
    return folder == LIBRARY or (folder / PYTHON).is_dir() or (folder / NATIVE).is_dir()


def missing_part(name: str, folder: Path) -> str:
    """What to say where a part has not been built."""
    built = [p.stem for p in folder.glob("*.fmu")] if folder.is_dir() else []
    command = "resilin build --native" if folder.name == NATIVE else "resilin build"
    if not built:
        return f"no part {name!r} in {folder}, which holds no FMU; run: {command}"
    return f"no part {name!r} in {folder}; {nearest(name, built)} ({command} makes parts)"


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
