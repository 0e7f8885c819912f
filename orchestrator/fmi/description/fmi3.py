"""FMI 3.0: all scalar types, arrays as their elements; clocks are left out."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import FmuError, printable
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

MOST_ELEMENTS = 500_000
"""Limit on the elements of all variables, and on the inputs that all outputs name."""
PORT = "Annotations/Annotation[@type='resilin']/Port"
"""Port and order of a variable in a description of ours."""
TYPED = ({*BOUNDED} - {"Real", "Integer"}) | {"Boolean", "String", "Binary", "Clock"}


def check(root: Any, findings: Findings) -> None:
    """Check names, references, start values, bounds, units and dimensions of all variables."""
    units = Units(root)
    units.report(findings)
    types = {entry.get("name"): entry for entry in root.findall("TypeDefinitions/*")}
    for name, entry in types.items():
        check_choices(entry, findings)
        units.check(entry, f"type '{printable(name or '')}'", findings)
    names: set[str] = set()
    variables = root.findall("ModelVariables/*")
    references: dict[str, str] = {}
    for entry in variables:
        shown = check_entry(entry, names, (*CAUSALITIES, "structuralParameter"), findings)
        if entry.tag not in TYPED:
            findings.refuse(entry, f"{shown} is of no type of FMI 3: {printable(entry.tag)}")
            continue
        other = references.setdefault(entry.get("valueReference") or "", shown)
        if other != shown:
            findings.refuse(entry, f"{shown} has the value reference of {other}")
        check_numbers(entry, entry, shown, findings)
        check_type(entry, types, units, shown, findings)
    check_ports(root.iterfind(f"ModelVariables/*/{PORT}"), findings)
    by_reference = {entry.get("valueReference"): entry for entry in variables}
    for entry in variables:
        for dimension in entry.findall("Dimension"):
            size = _size(dimension, by_reference)
            if not (size.isascii() and size.isdecimal()):
                findings.refuse(
                    dimension, "the dimension has no size, nor a variable that gives it"
                )
    for unknown, reference in _misplaced(root):
        fault = f"ModelStructure names no variable '{reference}'; what depends on what is not read"
        findings.warn(unknown.sourceline, fault, "structure")


def _misplaced(root: Any) -> Iterator[tuple[Any, str]]:
    """Entries of the structure, each with what it names that is not a variable's reference."""
    known = {entry.get("valueReference") for entry in root.findall("ModelVariables/*")}
    for unknown in root.findall("ModelStructure/*"):
        listed = [unknown.get("valueReference"), *(unknown.get("dependencies") or "").split()]
        for reference in listed:
            if reference not in known:
                yield unknown, printable(str(reference), most=20)


def reduced(path: Path, root: Any, warnings: tuple[str, ...]) -> Interface:
    """Interface from the tree; every array as its elements."""
    types = {entry.get("name"): entry for entry in root.findall("TypeDefinitions/*")}
    units = Units(root)
    entries = [entry for entry in root.findall("ModelVariables/*") if entry.tag != "Clock"]
    by_reference = {entry.get("valueReference"): entry for entry in entries}
    count = sum(math.prod(_shape(entry, by_reference)) for entry in entries)
    if count > MOST_ELEMENTS:
        raise FmuError(f"{path}: {count} variables and elements; at most {MOST_ELEMENTS} are read")
    depends = _dependencies(root, by_reference)
    variables: dict[str, Variable] = {}
    for entry in entries:
        for variable in _elements(entry, types, units, by_reference, depends):
            variables[variable.name] = variable
    return interface(path, root, 3, variables, warnings)


def _size(dimension: Any, by_reference: dict[str, Any]) -> str:
    """Size of a dimension as it is written; a structural parameter counts with its start value."""
    if (text := dimension.get("start")) is not None:
        return str(text)
    behind = by_reference.get(dimension.get("valueReference"))
    return "" if behind is None else behind.get("start") or ""


def _shape(entry: Any, by_reference: dict[str, Any]) -> list[int]:
    """Dimensions of a variable."""
    return [int(_size(dimension, by_reference)) for dimension in entry.findall("Dimension")]


def _dependencies(root: Any, by_reference: dict[str, Any]) -> dict[str, tuple[str, ...] | None]:
    """Inputs on which each output depends; None where it lists none, or all list too many."""
    inputs = {
        reference: list(_names(entry, by_reference))
        for reference, entry in by_reference.items()
        if entry.get("causality") == "input"
    }
    depends: dict[str, tuple[str, ...] | None] = {}
    left = MOST_ELEMENTS
    sound = next(_misplaced(root), None) is None
    for output in root.findall("ModelStructure/Output") if sound else ():
        listed = output.get("dependencies")
        found = [inputs[r] for r in (listed or "").split() if r in inputs]
        left -= sum(len(names) for names in found)
        known = listed is not None and left >= 0
        reference = output.get("valueReference")
        depends[reference] = tuple(itertools.chain(*found)) if known else None
    return depends


def _names(entry: Any, by_reference: dict[str, Any]) -> Iterator[str]:
    """Names of the elements of a variable, the last index fastest; its own name for a scalar."""
    name = entry.get("name")
    shape = _shape(entry, by_reference)
    if not shape:
        yield name
        return
    for index in itertools.product(*(range(1, size + 1) for size in shape)):
        yield f"{name}[{','.join(map(str, index))}]"


def _elements(
    entry: Any,
    types: dict[str, Any],
    units: Units,
    by_reference: dict[str, Any],
    depends: dict[str, tuple[str, ...] | None],
) -> Iterator[Variable]:
    """One variable for each element; numbers as floats, attributes of its type filled in."""
    kind = str(entry.tag)
    behind = types.get(entry.get("declaredType"))

    def attribute(key: str) -> str | None:
        own: str | None = entry.get(key)
        return own if own is not None or behind is None else behind.get(key)

    names = list(_names(entry, by_reference))
    starts = _starts(entry, kind, len(names))
    numeric = kind in BOUNDED
    least, most = bounds(attribute("min"), attribute("max")) if numeric else (None, None)
    items = behind.findall("Item") if kind == "Enumeration" and behind is not None else []
    reference = entry.get("valueReference")
    usual = "continuous" if kind.startswith("Float") else "discrete"
    causality = entry.get("causality") or "local"
    port = entry.find(PORT)
    for element, name in enumerate(names):
        yield Variable(
            name=name,
            reference=int(reference),
            kind=kind,
            causality=causality,
            unit=units.text(attribute("unit")),
            description=entry.get("description") or "",
            start=starts[element],
            least=least,
            most=most,
            port=_port(entry, port, len(names)),
            order=0 if port is None else int(port.get("order", "0")),
            choices=tuple(item.get("name") for item in items),
            codes=tuple(int(item.get("value")) for item in items),
            depends=depends.get(reference),
            variability=entry.get("variability") or usual,
            element=element,
            extent=len(names),
            initial=entry.get("initial") or "",
            unit_defined=units.defines(attribute("unit")),
        )


def _port(entry: Any, port: Any, count: int) -> str:
    """Name of the port of a variable: of our annotation, of the array, or before the last dot."""
    if port is not None:
        return str(port.get("name"))
    name = str(entry.get("name"))
    return name if count > 1 else name.rpartition(".")[0]


def _starts(entry: Any, kind: str, count: int) -> list[float | str | None]:
    """Start value of each element; one value counts for all."""
    if kind in {"String", "Binary"}:
        given: list[Any] = [start.get("value") for start in entry.findall("Start")]
    else:
        words = (entry.get("start") or "").split()
        given = [float(true(w)) if kind == "Boolean" else bound(w) for w in words]
    if len(given) == 1:
        return given * count
    return given if len(given) == count else [None] * count
