"""The file of an FMU: sealed with sorted entries and fixed dates, validated, described."""

from __future__ import annotations

import re
import shutil
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PLAIN_NAME = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)
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


def seal(raw: Path, sealed: Path, more: dict[str, bytes]) -> None:
    """Copy an archive with sorted entries, fixed dates and compression, and with `more` in it."""
    with (
        zipfile.ZipFile(raw) as source,
        zipfile.ZipFile(sealed, "w", zipfile.ZIP_DEFLATED) as target,
    ):
        for name in sorted({*source.namelist(), *more}):
            info = zipfile.ZipInfo(name, EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            text = more[name] if name in more else source.read(name)
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
    """What fmpy's validation finds, and whether there is anything to run.

    Its grammar of structured names takes most of the time of a build: names that are plainly right
    are not put to it.
    """
    from fmpy.model_description import ValidationError, read_model_description

    root = _description(path)
    names = [entry.get("name", "") for entry in root.findall("ModelVariables/*")]
    problems: list[str] = []
    try:
        read_model_description(
            str(path),
            validate=True,
            validate_variable_names=not all(map(PLAIN_NAME.fullmatch, names)),
            validate_model_structure=True,
        )
    except ValidationError as error:
        problems = [str(problem) for problem in error.problems]
    except Exception as error:  # what fmpy makes of a file that it cannot read
        problems = [str(error)]
    with zipfile.ZipFile(path) as archive:
        if not any(name.startswith("binaries/") for name in archive.namelist()):
            problems.append("the exporter left out its libraries: install pythonfmu again")
    return problems


def guid_in(path: Path) -> str:
    """GUID of a built file; empty where there is none to read."""
    from xml.etree import ElementTree

    try:
        root = _description(path)
    except (OSError, KeyError, zipfile.BadZipFile, ElementTree.ParseError):
        return ""
    return root.get("guid") or root.get("instantiationToken") or ""


def _description(path: Path) -> Any:
    """The root of a file's modelDescription."""
    from xml.etree import ElementTree

    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def described(name: str, path: Path, guid: str, *, fresh: bool) -> Built:
    """Entry of the table for a file on disk."""
    named = _description(path).findall("ModelVariables/*")
    variables = sum(entry.get("causality") != "independent" for entry in named)
    return Built(name, path, variables, path.stat().st_size, guid, fresh)
