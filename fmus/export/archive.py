"""The file of an FMU: sealed with sorted entries and fixed dates, validated, described."""

from __future__ import annotations

import shutil
import zipfile
from dataclasses import dataclass
from pathlib import Path

EPOCH = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class Built:
    """One FMU on disk."""

    name: str
    path: Path
    variables: int
    size: int
    guid: str
    fresh: bool


def seal(raw: Path, sealed: Path) -> None:
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


def put(fmu: Path, place: Path) -> None:
    """Copy an FMU to its place, where it appears whole or not at all."""
    place.parent.mkdir(parents=True, exist_ok=True)
    partial = place.with_name(f".{place.name}.part")
    shutil.copyfile(fmu, partial)
    partial.replace(place)


def problems_of(path: Path) -> list[str]:
    """What fmpy's validation finds, and whether there is anything to run."""
    from fmpy.validation import validate_fmu

    problems = [str(problem) for problem in validate_fmu(str(path))]
    with zipfile.ZipFile(path) as archive:
        if not any(name.startswith("binaries/") for name in archive.namelist()):
            problems.append("the exporter left out its libraries: install pythonfmu again")
    return problems


def guid_in(path: Path) -> str:
    """GUID of a built file; empty where there is none to read."""
    from xml.etree import ElementTree

    try:
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError):
        return ""
    return root.get("guid", "")


def described(name: str, path: Path, guid: str, *, fresh: bool) -> Built:
    """Entry of the table for a file on disk."""
    from xml.etree import ElementTree

    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    variables = len(root.findall("ModelVariables/ScalarVariable"))
    return Built(name, path, variables, path.stat().st_size, guid, fresh)
