"""The file `terminalsAndIcons.xml` of FMI 3.0: a part's ports as terminals, and its icon."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..part import Variable

SIDE = 100.0
"""Width and height of the icon's coordinates, as of the drawing itself."""
MARK = 4.0
"""Half the width of a terminal's mark."""


def terminals_and_icons(variables: list[Variable], *, icon: bool) -> Element:
    """XML tree: one terminal for each port, with the member's name as its role.

    A port's members are plain signals; two terminals fit where their members have the same names
    (matching rule `plug`), an input of one part for an output of another. Ports that are received
    are on the left of the icon, those that are provided on the right.
    """
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    if icon:
        drawn = SubElement(root, "GraphicalRepresentation")
        corners = {"x1": "0.0", "y1": "0.0", "x2": repr(SIDE), "y2": repr(SIDE)}
        scale = {"suggestedScalingFactorTo_mm": "0.2"}
        SubElement(drawn, "CoordinateSystem", {**corners, **scale})
        SubElement(drawn, "Icon", corners)
    ports = _ports(variables)
    if ports:
        listed = SubElement(root, "Terminals")
        for (name, causality), members in ports.items():
            _terminal(listed, name, causality, members, _place(ports, name, causality), icon)
    return root


def _ports(variables: list[Variable]) -> dict[tuple[str, str], list[Variable]]:
    """Name and causality of each port -> its members, in the order of the variables."""
    ports: dict[tuple[str, str], list[Variable]] = {}
    for variable in variables:
        if variable.quantity.port:
            key = (variable.quantity.port, variable.causality)
            ports.setdefault(key, []).append(variable)
    return ports


def _terminal(
    listed: Element,
    name: str,
    causality: str,
    members: list[Variable],
    place: tuple[float, float],
    icon: bool,
) -> None:
    terminal = SubElement(
        listed,
        "Terminal",
        name=name,
        matchingRule="plug",
        terminalKind=f"resilin.{'received' if causality == 'input' else 'provided'}",
        description=members[0].quantity.meaning,
    )
    for member in members:
        SubElement(
            terminal,
            "TerminalMemberVariable",
            variableName=member.name,
            memberName=member.name.removeprefix(f"{name}."),
            variableKind="signal",
        )
    if icon:
        x, y = place
        SubElement(
            terminal,
            "TerminalGraphicalRepresentation",
            iconBaseName=causality,
            x1=repr(x - MARK),
            y1=repr(y - MARK),
            x2=repr(x + MARK),
            y2=repr(y + MARK),
        )


def _place(
    ports: dict[tuple[str, str], list[Variable]], name: str, causality: str
) -> tuple[float, float]:
    """Where a terminal is: evenly spread over its side."""
    beside = [port for port, kind in ports if kind == causality]
    return (0.0 if causality == "input" else SIDE), round(
        SIDE * (beside.index(name) + 1) / (len(beside) + 1), 1
    )
