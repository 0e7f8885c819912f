"""A native FMU: the Python FMU's modelDescription, the C sources, and a library a platform."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..export.documentation import TERMINALS
from ..model_description import model_description
from ..part import Part, Variable
from . import fmi3_description, table
from .link import libraries
from .terminals import terminals_and_icons
from .translate import unit, words

HERE = Path(__file__).parent
FIXED = ("instance.h", "dual.h", "semantics.h")
"""Files that are the same in every native FMU, beside those of its version of FMI."""


def marks(platforms: list[str], fmi: int) -> list[str]:
    """What the digest of a native FMU covers beside the sources of its part."""
    digest = hashlib.sha256(words.header().encode())
    for path in sorted([*HERE.rglob("*.py"), *HERE.glob("*.c"), *HERE.glob("*.h")]):
        digest.update(path.read_bytes())
    return ["native", digest.hexdigest(), *platforms, *(["fmi3"] if fmi == 3 else [])]


def sources(part: Part, guid: str, variables: list[Variable], into: Path, fmi: int) -> list[Path]:
    """Write all that a host needs to compile the part; returns the files to be compiled."""
    translation = unit.part(part.physics, part.name)
    into.mkdir(parents=True)
    interface = f"fmi{fmi}.c"
    names = (interface, f"fmi{fmi}.h", *FIXED)
    texts = {name: (HERE / name).read_text(encoding="utf-8") for name in names} | {
        "words.h": words.header(),
        "part.h": table.header(part, guid, variables, translation),
        f"{part.name}.h": translation.header,
        f"{part.name}.c": translation.source,
    }
    for name, text in texts.items():
        (into / name).write_text(text, encoding="utf-8", newline="\n")
    return [into / interface, into / f"{part.name}.c"]


def packed(
    part: Part,
    identifier: str,
    guid: str,
    alike: str,
    version: str,
    starts: dict[str, float],
    platforms: list[str],
    into: Path,
    fmi: int,
    *,
    icon: bool,
) -> Path:
    """Translate a part, compile it for each platform and pack `into/IDENTIFIER.fmu`.

    `alike` is the digest of the sources and start values, the same as in the Python FMU; `fmi` is
    the version of FMI, 2 or 3; `icon` says whether an FMU of FMI 3 is given one. The rows of both
    versions are made by the same code.
    """
    variables = part.variables_with(starts)
    files = sources(part, guid, variables, into / "sources", fmi)
    libraries(files, platforms, identifier, into / "binaries", fmi)
    named = [file.name for file in files]
    given = (part, identifier, guid, version, variables)
    if fmi == 3:
        texts = {
            "modelDescription.xml": fmi3_description.model_description(*given, sources=alike),
            "sources/buildDescription.xml": _build_description(identifier, named),
            f"{TERMINALS}/{TERMINALS}.xml": terminals_and_icons(variables, icon=icon),
        }
    else:
        root = model_description(*given, sources=alike, native=True)
        _list_sources(root, named)
        texts = {"modelDescription.xml": root}
    path = into / f"{identifier}.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, root in texts.items():
            indent(root)
            archive.writestr(name, tostring(root, encoding="UTF-8", xml_declaration=True))
        for file in sorted([*(into / "sources").iterdir(), *(into / "binaries").rglob("*.*")]):
            archive.write(file, file.relative_to(into).as_posix())
    return path


def _list_sources(root: Element, files: list[str]) -> None:
    """Name the files to be compiled as FMI 2.0 does, in the modelDescription."""
    slave = root.find("CoSimulation")
    assert slave is not None
    listed = SubElement(slave, "SourceFiles")
    for file in files:
        SubElement(listed, "File", name=file)


def _build_description(identifier: str, files: list[str]) -> Element:
    """The files to be compiled as FMI 3.0 names them, in a file of its own."""
    build = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(build, "BuildConfiguration", modelIdentifier=identifier)
    listed = SubElement(configuration, "SourceFileSet", language="C99")
    for file in files:
        SubElement(listed, "SourceFile", name=file)
    return build
