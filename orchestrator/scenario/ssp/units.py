"""Units as SSP defines them: base units, exponents, a factor and an offset."""

from __future__ import annotations

from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ...units import BASES, Definition, UnitError, check_unit, declared, definition
from .names import tag


def declared_units(listed: Any) -> dict[str, str]:
    """Text of each unit that a list of units defines, as `orchestrator.units` reads it.

    A unit without exponents whose name is not known is left out: such are written for units
    of which only the name is known.
    """
    found: dict[str, str] = {}
    for unit in [] if listed is None else listed.findall(tag("ssc:Unit")):
        name, base = unit.get("name") or "", unit.find(tag("ssc:BaseUnit"))
        if base is None:
            continue
        try:
            meaning = Definition.of(base.attrib)
            if meaning == definition("1"):
                check_unit(name)
            found[name] = declared(name, meaning)
        except ValueError:
            continue
    return found


def _units(root: Element, names: set[str]) -> None:
    if names:
        _defined(SubElement(root, tag("ssd:Units")), names)


def _defined(listed: Element, names: set[str]) -> None:
    """Define units by base units; one that is not known has none."""
    for name in sorted(names):
        unit = SubElement(listed, tag("ssc:Unit"), name=name)
        base = SubElement(unit, tag("ssc:BaseUnit"))
        for key, value in _powers(name).items():
            base.set(key, value)


def _powers(name: str) -> dict[str, str]:
    try:
        meaning = definition(name)
    except UnitError:
        return {}
    powers = {b: str(p) for b, p in zip(BASES, meaning.powers, strict=False) if p}
    if meaning.factor != 1.0:
        powers["factor"] = repr(meaning.factor)
    if meaning.offset:
        powers["offset"] = repr(meaning.offset)
    return powers
