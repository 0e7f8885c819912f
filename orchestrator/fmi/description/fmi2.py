"""FMI 2.0: checks that the schema does not make, and the description as an `Interface`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import printable
from .attributes import interface, true
from .checks import (
    BOUNDED,
    CAUSALITIES,
    Units,
    bound,
    bounds,
    check_choices,
    check_entry,
    check_numbers,
    check_ports,
    check_type,
)
from .findings import Findings
from .variable import Interface, Variable

SCALARS = "ModelVariables/ScalarVariable"
TYPED = ("Real", "Integer", "Boolean", "String", "Enumeration")


def check(root: Any, findings: Findings) -> None:
    """Check names, references, start values, bounds, units and types of all variables."""
    units = Units(root)
    units.report(findings)
    types = {entry.get("name"): entry for entry in root.findall("TypeDefinitions/SimpleType")}
    for name, entry in types.items():
        for typed in entry:
            check_choices(typed, findings)
            units.check(typed, f"type '{printable(name or '')}'", findings)
    names: set[str] = set()
    settable: dict[tuple[str, str], str] = {}
    for scalar in root.findall("ModelVariables/*"):
        if scalar.tag != "ScalarVariable":
            findings.refuse(scalar, f"{printable(scalar.tag)} is not a ScalarVariable")
            continue
        shown = check_entry(scalar, names, CAUSALITIES, findings)
        listed = [entry for entry in scalar if entry.tag in TYPED]
        if len(listed) != 1:
            fault = f"is a ScalarVariable with {len(listed)} of {', '.join(TYPED)}; it needs one"
            findings.refuse(scalar, f"{shown} {fault}")
            continue
        check_numbers(scalar, listed[0], shown, findings)
        check_type(listed[0], types, units, shown, findings)
        if scalar.get("causality") in {"parameter", "input"}:
            key = (str(listed[0].tag), scalar.get("valueReference") or "")
            other = settable.setdefault(key, shown)
            if other != shown:
                findings.warn(scalar.sourceline, f"{shown} is set with {other}: one reference")
    for unknown, shown in _misplaced(root):
        fault = f"ModelStructure names no variable '{shown}'; what depends on what is not read"
        findings.warn(unknown.sourceline, fault, "structure")
    check_ports(root.iterfind("ModelVariables/*/Annotations/Tool[@name='resilin']/Port"), findings)


def _misplaced(root: Any) -> Iterator[tuple[Any, str]]:
    """Entries of the structure, each with what it names that is not the place of a variable."""
    count = len(root.findall(SCALARS))
    for unknown in root.iterfind("ModelStructure//Unknown"):
        for index in (unknown.get("index"), *(unknown.get("dependencies") or "").split()):
            if not _is_place(index, count):
                yield unknown, printable(str(index), most=20)


def _is_place(text: str | None, count: int) -> bool:
    """Whether a text is the place of a variable, 1 to `count`."""
    plain = text is not None and text.isascii() and text.isdigit() and len(text) < 10
    return plain and 1 <= int(text or "0") <= count


def reduced(path: Path, root: Any, warnings: tuple[str, ...]) -> Interface:
    """Interface from the tree and our annotations."""
    types = {entry.get("name"): entry for entry in root.findall("TypeDefinitions/SimpleType")}
    units = Units(root)
    scalars = root.findall(SCALARS)
    names = [scalar.get("name") for scalar in scalars]
    inputs = {k for k, scalar in enumerate(scalars) if scalar.get("causality") == "input"}
    depends: dict[int, tuple[str, ...] | None] = {}
    sound = next(_misplaced(root), None) is None
    for unknown in root.findall("ModelStructure/Outputs/Unknown") if sound else ():
        listed = unknown.get("dependencies")
        places = [int(text) - 1 for text in (listed or "").split()]
        known = None if listed is None else tuple(names[k] for k in places if k in inputs)
        depends[int(unknown.get("index")) - 1] = known
    variables = {
        name: _variable(scalar, types, units, depends.get(k))
        for k, (name, scalar) in enumerate(zip(names, scalars, strict=True))
    }
    return interface(path, root, 2, variables, warnings)


def _variable(
    scalar: Any, types: dict[str, Any], units: Units, depends: tuple[str, ...] | None
) -> Variable:
    """One variable; numbers as floats, attributes of its type filled in."""
    name = scalar.get("name")
    typed = next(entry for entry in scalar if entry.tag in TYPED)
    kind = str(typed.tag)
    declared = types.get(typed.get("declaredType"))
    behind = None if declared is None else declared.find(kind)

    def attribute(key: str) -> str | None:
        own: str | None = typed.get(key)
        return own if own is not None or behind is None else str(behind.get(key) or "") or None

    numeric = kind in BOUNDED
    start: float | str | None = typed.get("start")
    if start is not None and numeric:
        start = bound(typed.get("start"))
    if start is not None and kind == "Boolean":
        start = float(true(start))
    least, most = bounds(attribute("min"), attribute("max")) if numeric else (None, None)
    items = [] if behind is None else behind.findall("Item")
    port = scalar.find("Annotations/Tool[@name='resilin']/Port")
    return Variable(
        name=name,
        reference=int(scalar.get("valueReference")),
        kind=kind,
        causality=scalar.get("causality") or "local",
        unit=units.text(attribute("unit")),
        description=scalar.get("description") or "",
        start=start,
        least=least,
        most=most,
        port=name.rpartition(".")[0] if port is None else port.get("name"),
        order=0 if port is None else int(port.get("order", "0")),
        choices=tuple(item.get("name") for item in items),
        codes=tuple(int(item.get("value")) for item in items),
        depends=depends,
        variability=scalar.get("variability") or "continuous",
        initial=scalar.get("initial") or "",
        unit_defined=units.defines(attribute("unit")),
    )
