"""Reading a model description with care.

The XML is parsed once, guarded (no DOCTYPE, bounded depth), compared with the schema of
FMI that fmpy contains, checked for what names, references and types depend on, and reduced to the
few facts that wiring and running need.
"""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

from ...errors import FmuError, printable
from ..archive import read_description
from ..built import digest_of
from ..safe_xml import guarded
from . import fmi2, fmi3
from .attributes import NAMES
from .findings import Findings
from .schema import against_schema
from .variable import Interface

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
FILE_NAME = re.compile(r"""[^\s./\\:*?"<>|][^/\\:*?"<>|]{0,200}""")
KEPT = 64
"""Interfaces that are remembered: those of a few scenarios."""

MOST_NODES = 400_000
"""Elements of a description: what is made of more of them takes a gigabyte and half a minute."""

VERSIONS: dict[str, ModuleType] = {"2.0": fmi2, "3.0": fmi3}


def read_interface(path: Path) -> Interface:
    """Interface of an FMU file; `FmuError` with file, line and cause where it cannot be used.

    A file of the same content is read once: a study loads its parts again for every run.
    """
    try:
        digest = digest_of(path) if path.is_file() else ""
    except (FmuError, OSError, ValueError):
        digest = ""  # what is wrong with the file is said where it is read
    return _read(path, digest)


@lru_cache(maxsize=KEPT)
def _read(path: Path, digest: str) -> Interface:
    interface, findings = examined(path)
    if interface is None:
        count = len(findings.errors)
        more = f" (and {count - 1} more; resilin check lists all)" if count > 1 else ""
        raise FmuError(f"{path}: modelDescription.xml: {findings.errors[0]}{more}")
    return interface


def examined(path: Path) -> tuple[Interface | None, Findings]:
    """Interface of an FMU file, None where an error refuses it, and everything found in it.

    Raises `FmuError` for what is not a description of an FMU at all.
    """
    text = read_description(path)
    root = guarded(f"{path}: modelDescription.xml", text)
    count = sum(1 for _ in root.iter())
    if count > MOST_NODES:
        raise FmuError(
            f"{path}: modelDescription.xml has {count} elements; at most {MOST_NODES} are read"
        )
    version = _version(path, root)
    findings = Findings()
    _check_kind(path, root, findings)
    against_schema(root, text, version, findings)
    if not root.get(NAMES[int(version[0])][0]):
        findings.refuse(root, f"has no {NAMES[int(version[0])][0]}")
    VERSIONS[version].check(root, findings)
    if findings.errors:
        return None, findings
    interface: Interface = VERSIONS[version].reduced(path, root, findings.warnings)
    return interface, findings


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


def _check_kind(path: Path, root: Any, findings: Findings) -> None:
    """Refuse an FMU that is for nothing that we know, or whose identifier could leave its folder.

    One that is for both is taken for co-simulation: its own solver knows it best.
    """
    kind = root.find("CoSimulation")
    if kind is None:
        kind = root.find("ModelExchange")
    if kind is None:
        raise FmuError(f"{path}: is neither for co-simulation nor for model exchange")
    identifier = kind.get("modelIdentifier") or ""
    shown = printable(identifier)
    if not FILE_NAME.fullmatch(identifier) or shown != identifier:
        raise FmuError(f"{path}: modelIdentifier '{shown}' is not the name of a library")
    if not IDENTIFIER.fullmatch(identifier):
        findings.warn(
            kind.sourceline,
            f"modelIdentifier '{shown}' is not a C identifier; taken as the name of the library",
        )
