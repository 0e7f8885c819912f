"""A case as an SSP archive: one system, its components' connectors, and the wires."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

from .case import Case

DESCRIPTION = "http://ssp-standard.org/SSP1/SystemStructureDescription"
COMMON = "http://ssp-standard.org/SSP1/SystemStructureCommon"


@dataclass(frozen=True)
class Parameter:
    """A start value by its full name, as FMPy takes it."""

    name: str
    value: float


class Parameters:
    """All start values of a case."""

    def __init__(self, case: Case) -> None:
        self.parameters = [
            Parameter(f"{c.name}.{s.name}", s.value) for c in case.components for s in c.starts
        ]


def write_ssp(case: Case, path: Path) -> None:
    """The archive; FMUs under `resources/`, each file once."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", description(case))
        for file in {component.path for component in case.components}:
            archive.write(file, f"resources/{Path(file).name}")


def description(case: Case) -> bytes:
    """The system's structure: wired and watched variables are connectors."""
    root = Element(
        "ssd:SystemStructureDescription",
        {"xmlns:ssd": DESCRIPTION, "xmlns:ssc": COMMON, "version": "1.0", "name": "peers"},
    )
    system = SubElement(root, "ssd:System", name="peers")
    elements = SubElement(system, "ssd:Elements")
    for component in case.components:
        outputs = {w.output for w in case.wires if w.source == component.name}
        outputs |= {w.name for w in case.watched if w.component == component.name}
        inputs = {w.input for w in case.wires if w.target == component.name}
        made = SubElement(
            elements,
            "ssd:Component",
            name=component.name,
            type="application/x-fmu-sharedlibrary",
            source=f"resources/{Path(component.path).name}",
        )
        connectors = SubElement(made, "ssd:Connectors")
        for kind, names in (("input", inputs), ("output", outputs)):
            for name in sorted(names):
                connector = SubElement(connectors, "ssd:Connector", name=name, kind=kind)
                SubElement(connector, "ssc:Real")
    connections = SubElement(system, "ssd:Connections")
    for wire in case.wires:
        SubElement(
            connections,
            "ssd:Connection",
            startElement=wire.source,
            startConnector=wire.output,
            endElement=wire.target,
            endConnector=wire.input,
        )
    return bytes(tostring(root, encoding="utf-8", xml_declaration=True))
