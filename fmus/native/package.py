"""A native FMU: the same modelDescription as the Python FMU, and a library a platform."""

from __future__ import annotations

import hashlib
import zipfile
from importlib import metadata
from pathlib import Path
from xml.etree.ElementTree import indent, tostring

from ..model_description import model_description
from ..part import Part
from . import table
from .code import compiled
from .link import libraries

HERE = Path(__file__).parent


def marks(platforms: list[str]) -> list[str]:
    """What the digest of a native FMU covers beside the sources of its part."""
    digest = hashlib.sha256()
    for path in sorted([*HERE.glob("*.py"), *HERE.glob("*.c")]):
        digest.update(path.read_bytes())
    tools = [f"{name} {metadata.version(name)}" for name in ("numba", "llvmlite")]
    return ["native", digest.hexdigest(), *tools, *platforms]


def packed(
    part: Part,
    identifier: str,
    guid: str,
    version: str,
    starts: dict[str, float],
    platforms: list[str],
    into: Path,
) -> Path:
    """Compile a part, link it for each platform and pack `into/IDENTIFIER.fmu`."""
    variables = part.variables_with(starts)
    code = compiled(part.physics)
    header = table.header(part, guid, variables, code.causes)
    binaries = into / "binaries"
    libraries(code, header, platforms, identifier, binaries)
    tool = f"Resilin with numba {metadata.version('numba')}"
    root = model_description(
        part, identifier, guid, version, variables, tool=tool, needs_execution_tool=False
    )
    indent(root)
    path = into / f"{identifier}.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(
            "modelDescription.xml", tostring(root, encoding="UTF-8", xml_declaration=True)
        )
        for library in sorted(binaries.rglob("*.*")):
            archive.write(library, library.relative_to(into).as_posix())
    return path
