"""Units as SSP defines them: base units, exponents and a factor."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement

from ...units import UnitError, factor
from .names import tag

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def _units(root: Element, names: set[str]) -> None:
    if names:
        _defined(SubElement(root, tag("ssd:Units")), names)


def _defined(listed: Element, names: set[str]) -> None:
    """Define units by base units; one that pint does not know is a pure number."""
    for name in sorted(names):
        unit = SubElement(listed, tag("ssc:Unit"), name=name)
        base = SubElement(unit, tag("ssc:BaseUnit"))
        for key, value in _powers(name).items():
            base.set(key, value)


def _powers(name: str) -> dict[str, str]:
    from ...units import parsed

    try:
        dimensions = dict(parsed(name).dimensionality)
        scale = factor(name, "*".join(f"{b}^{int(p)}" for b, p in _bases(dimensions)) or "1")
    except (UnitError, ValueError):
        return {}
    powers = {b: str(int(p)) for b, p in _bases(dimensions)}
    if name in {"rad", "rad/s"}:
        powers["rad"] = "1"
    return powers if scale == 1.0 else {**powers, "factor": repr(scale)}


DIMENSIONS = {
    "[mass]": "kg", "[length]": "m", "[time]": "s", "[current]": "A", "[temperature]": "K",
    "[substance]": "mol", "[luminosity]": "cd",
}  # fmt: skip


def _bases(dimensions: Mapping[str, float]) -> list[tuple[str, float]]:
    return [(DIMENSIONS[d], p) for d, p in dimensions.items() if p == int(p)]
