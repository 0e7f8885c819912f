"""A native FMU: the Python FMU's modelDescription, the C sources, and a library a platform."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path
from xml.etree.ElementTree import SubElement, indent, tostring

from ..model_description import model_description
from ..part import Part, Variable
from . import table
from .link import libraries
from .translate import unit, words

HERE = Path(__file__).parent
FIXED = ("layer.c", "fmi2.h", "semantics.h")
"""Files that are the same in every native FMU."""


def marks(platforms: list[str]) -> list[str]:
    """What the digest of a native FMU covers beside the sources of its part."""
    digest = hashlib.sha256(words.header().encode())
    for path in sorted([*HERE.rglob("*.py"), *HERE.glob("*.c"), *HERE.glob("*.h")]):
        digest.update(path.read_bytes())
    return ["native", digest.hexdigest(), *platforms]


def sources(part: Part, guid: str, variables: list[Variable], into: Path) -> list[Path]:
    """Write all that a host needs to compile the part; returns the files to be compiled."""
    translation = unit.part(part.physics, part.name)
    into.mkdir(parents=True)
    texts = {name: (HERE / name).read_text(encoding="utf-8") for name in FIXED} | {
        "words.h": words.header(),
        "table.h": table.header(part, guid, variables, translation),
        f"{part.name}.h": translation.header,
        f"{part.name}.c": translation.source,
    }
    for name, text in texts.items():
        (into / name).write_text(text, encoding="utf-8", newline="\n")
    return [into / "layer.c", into / f"{part.name}.c"]


def packed(
    part: Part,
    identifier: str,
    guid: str,
    version: str,
    starts: dict[str, float],
    platforms: list[str],
    into: Path,
) -> Path:
    """Translate a part, compile it for each platform and pack `into/IDENTIFIER.fmu`."""
    variables = part.variables_with(starts)
    files = sources(part, guid, variables, into / "sources")
    libraries(files, platforms, identifier, into / "binaries")
    root = model_description(
        part, identifier, guid, version, variables, tool="Resilin", needs_execution_tool=False
    )
    listed = root.find("CoSimulation")
    assert listed is not None
    listed = SubElement(listed, "SourceFiles")
    for file in files:
        SubElement(listed, "File", name=file.name)
    indent(root)
    path = into / f"{identifier}.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(
            "modelDescription.xml", tostring(root, encoding="UTF-8", xml_declaration=True)
        )
        for file in sorted([*(into / "sources").iterdir(), *(into / "binaries").rglob("*.*")]):
            archive.write(file, file.relative_to(into).as_posix())
    return path
