"""Names of the SSP standard: namespaces and types of files; and our own annotation."""

from __future__ import annotations

from typing import Any

BASE = "http://ssp-standard.org/SSP1/SystemStructure"
NAMESPACES = {
    "ssd": f"{BASE}Description",
    "ssc": f"{BASE}Common",
    "ssv": f"{BASE}ParameterValues",
    "ssm": f"{BASE}ParameterMapping",
}
FMU = "application/x-fmu-sharedlibrary"
PARAMETERS = "application/x-ssp-parameter-set"
MAPPING = "application/x-ssp-parameter-mapping"
ANNOTATION = "org.resilin.scenario"
"""Type of the annotation with the tables of a scenario for which SSP has no place, as JSON."""
OLD_ANNOTATION = "org.resilin.scene"
"""The same in archives that the previous release has written."""

REALS = ("Real", "Float64", "Float32")
WHOLE = ("Integer", *(f"{u}Int{n}" for u in ("", "U") for n in (8, 16, 32, 64)))


def tag(name: str) -> str:
    """`ssd:System` as lxml writes it, `{namespace}System`."""
    prefix, _, local = name.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{local}"


def local(element: Any) -> str:
    """Name of an element without its namespace; "" for a comment."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
