"""SSP archives written piece by piece."""

from __future__ import annotations

import zipfile
from pathlib import Path

from typer.testing import CliRunner

from orchestrator.scenario.ssp.names import NAMESPACES

runner = CliRunner()
SPACES = " ".join(f'xmlns:{prefix}="{name}"' for prefix, name in NAMESPACES.items())
FMU = 'type="application/x-fmu-sharedlibrary"'


def described(system: str, head: str = "", tail: str = "", version: str = "1.0") -> str:
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<ssd:SystemStructureDescription {SPACES}'
        f' version="{version}" name="of others"{head}>{system}{tail}'
        "</ssd:SystemStructureDescription>"
    )


def packed(path: Path, description: str | bytes, **files: bytes | Path) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", description)
        for name, content in files.items():
            entry = name.replace("__", ".").replace("resources_", "resources/")
            data = content.read_bytes() if isinstance(content, Path) else content
            archive.writestr(entry, data)
    return path


def real(name: str, value: float, unit: str = "") -> str:
    measured = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value!r}"{measured}/></ssv:Parameter>'


def bound(*parameters: str, mapping: str = "", more: str = "") -> str:
    inner = f'<ssv:ParameterSet version="1.0" name="x"><ssv:Parameters>{"".join(parameters)}'
    inner += "</ssv:Parameters></ssv:ParameterSet>"
    return (
        f"<ssd:ParameterBindings><ssd:ParameterBinding{more}><ssd:ParameterValues>{inner}"
        f"</ssd:ParameterValues>{mapping}</ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def connectors(**kinds: str) -> str:
    made = "".join(
        f'<ssd:Connector name="{n.replace("__", ".")}" kind="{k}"><ssc:Real/></ssd:Connector>'
        for n, k in kinds.items()
    )
    return f"<ssd:Connectors>{made}</ssd:Connectors>"


def component(name: str, source: str, inside: str = "") -> str:
    return f'<ssd:Component name="{name}" {FMU} source="{source}">{inside}</ssd:Component>'


def joined(start: str, end: str, inside: str = "", more: str = "") -> str:
    ends = []
    for prefix, text in (("start", start), ("end", end)):
        owner, _, name = text.partition(":")
        element = f'{prefix}Element="{owner}" ' if owner else ""
        ends.append(f'{element}{prefix}Connector="{name}"')
    return f"<ssd:Connection {' '.join(ends)}{more}>{inside}</ssd:Connection>"


def elements(inside: str, connections: str = "", bindings: str = "") -> str:
    wires = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    content = f"{bindings}<ssd:Elements>{inside}</ssd:Elements>{wires}"
    return f'<ssd:System name="top">{content}</ssd:System>'


PUSH = component(
    "payload", "resources/payload.fmu",
    connectors(force__value="input", displacement="output")
    + bound(real("mass", 2.0, "g"), real("force.value", 3.0, "mN")),
)  # fmt: skip
ALONE = f'<ssd:System name="top"><ssd:Elements>{PUSH}</ssd:Elements></ssd:System>'
SPAN = '<ssd:DefaultExperiment startTime="0" stopTime="0.5"/>'
