"""Reading a model description with care.

The XML is parsed once, guarded (no DOCTYPE, bounded depth), validated against the schema of
FMI that fmpy contains, checked for what the schema does not cover, and reduced to the few facts
that wiring and running need.
"""

from __future__ import annotations

import functools
import re
from pathlib import Path
from types import ModuleType
from typing import Any

from ...errors import FmuError, printable
from ..archive import read_description
from ..safe_xml import guarded
from . import fmi2, fmi3
from .variable import Interface

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,200}")
MOST_LINED = 5000
VERSIONS: dict[str, ModuleType] = {"2.0": fmi2, "3.0": fmi3}


def read_interface(path: Path) -> Interface:
    """Interface of an FMU file; `FmuError` with file, line and cause where it cannot be used."""
    text = read_description(path)
    root = guarded(f"{path}: modelDescription.xml", text)
    version = _version(path, root)
    _check_kind(path, root)
    problems = _against_schema(root, text, version)
    warnings: list[str] = []
    if not problems:
        VERSIONS[version].check(root, problems, warnings)
    if problems:
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise FmuError(f"{path}: modelDescription.xml: {problems[0]}{more}")
    interface: Interface = VERSIONS[version].reduced(path, root, tuple(warnings))
    return interface


@functools.cache
def _schema(version: str) -> Any:
    """The schema of an FMI version that comes with fmpy."""
    import fmpy
    from lxml import etree

    folder = Path(fmpy.__file__).parent / "schema"
    names = {"2.0": "fmi2/fmi2ModelDescription.xsd", "3.0": "fmi3/fmi3ModelDescription.xsd"}
    return etree.XMLSchema(file=str(folder / names[version]))


def _against_schema(root: Any, text: bytes, version: str) -> list[str]:
    """Violations of the schema, with lines where the document is of a usual size.

    Collecting all faults takes quadratic time in their number; a parser that validates
    stops at the first, but does not give its line.
    """
    from lxml import etree

    variables = root.find("ModelVariables")
    if variables is not None and len(variables) > MOST_LINED:
        parser = etree.XMLParser(schema=_schema(version), resolve_entities=False, no_network=True)
        try:
            etree.fromstring(text, parser)
        except etree.XMLSyntaxError as error:
            return [f"line unknown: {printable(str(error))}"]
        return []
    schema = _schema(version)
    if schema.validate(root):
        return []
    return [f"line {e.line}: {printable(e.message)}" for e in schema.error_log]


def _version(path: Path, root: Any) -> str:
    """FMI version, 2.0 or 3.0; minor releases of FMI 3 are read as 3.0."""
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise FmuError(f"{path}: modelDescription.xml has no fmiVersion")
    known = "3.0" if re.fullmatch(r"3\.[0-9]{1,3}", version) else version
    if known not in VERSIONS:
        raise FmuError(
            f"{path}: FMI version {printable(version)!r} is not supported;"
            f" use FMI {', '.join(VERSIONS)}"
        )
    return known


def _check_kind(path: Path, root: Any) -> None:
    """Refuse an FMU that is not for co-simulation, or whose identifier is not a C identifier."""
    kind = root.find("CoSimulation")
    if kind is None:
        raise FmuError(f"{path}: not a co-simulation FMU; export it for co-simulation")
    identifier = kind.get("modelIdentifier") or ""
    if not IDENTIFIER.fullmatch(identifier):
        raise FmuError(f"{path}: modelIdentifier '{printable(identifier)}' is not a C identifier")
