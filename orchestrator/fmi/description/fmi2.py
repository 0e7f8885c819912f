"""FMI 2.0: checks that the schema does not make, and the description as an `Interface`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...errors import printable
from .attributes import interface, true
from .checks import BOUNDED, faults, name_faults
from .variable import Interface, Variable

SCALARS = "ModelVariables/ScalarVariable"
TYPED = ("Real", "Integer", "Boolean", "String", "Enumeration")


def check(root: Any, problems: list[str], warnings: list[str]) -> None:
    """Check names, references, start values, bounds and units of all variables."""
    units = {unit.get("name") for unit in root.findall("UnitDefinitions/Unit")}
    types = {entry.get("name") for entry in root.findall("TypeDefinitions/SimpleType")}
    names: set[str] = set()
    references: dict[tuple[str, str], str] = {}
    scalars = root.findall(SCALARS)
    for scalar in scalars:
        name = scalar.get("name") or ""
        where = f"line {scalar.sourceline}: variable '{printable(name)}'"
        problems.extend(f"{where} {fault}" for fault in name_faults(name, names))
        for typed in scalar:
            if typed.tag not in TYPED:
                continue
            key = (str(typed.tag), scalar.get("valueReference") or "")
            other = references.setdefault(key, name)
            if other != name:
                warnings.append(f"{where} is an alias of '{printable(other)}'")
            problems.extend(f"{where} {fault}" for fault in faults(typed, units))
            declared = typed.get("declaredType")
            if declared is not None and declared not in types:
                problems.append(f"{where} has type '{printable(declared)}', which is not defined")
    for unknown in root.iterfind("ModelStructure//Unknown"):
        indices = [unknown.get("index"), *(unknown.get("dependencies") or "").split()]
        for index in indices:
            if not _is_place(index, len(scalars)):
                where = f"line {unknown.sourceline}"
                shown = printable(str(index), most=20)
                problems.append(f"{where}: ModelStructure names no variable '{shown}'")
    for port in root.iterfind("ModelVariables/*/Annotations/Tool[@name='resilin']/Port"):
        if not port.get("name") or port.get("order", "0") not in {"0", "1", "2"}:
            where = f"line {port.sourceline}"
            problems.append(f"{where}: the port's annotation needs a name and an order 0, 1 or 2")


def _is_place(text: str | None, count: int) -> bool:
    """Whether a text is the place of a variable, 1 to `count`."""
    plain = text is not None and text.isascii() and text.isdigit() and len(text) < 10
    return plain and 1 <= int(text or "0") <= count


def reduced(path: Path, root: Any, warnings: tuple[str, ...]) -> Interface:
    """Interface from the tree and our annotations."""
    types = {entry.get("name"): entry for entry in root.findall("TypeDefinitions/SimpleType")}
    scalars = root.findall(SCALARS)
    names = [scalar.get("name") for scalar in scalars]
    inputs = {k for k, scalar in enumerate(scalars) if scalar.get("causality") == "input"}
    depends: dict[int, tuple[str, ...] | None] = {}
    for unknown in root.findall("ModelStructure/Outputs/Unknown"):
        listed = unknown.get("dependencies")
        places = [int(text) - 1 for text in (listed or "").split()]
        known = None if listed is None else tuple(names[k] for k in places if k in inputs)
        depends[int(unknown.get("index")) - 1] = known
    variables = {
        name: _variable(scalar, types, depends.get(k))
        for k, (name, scalar) in enumerate(zip(names, scalars, strict=True))
    }
    return interface(path, root, 2, variables, warnings)


def _variable(scalar: Any, types: dict[str, Any], depends: tuple[str, ...] | None) -> Variable:
    """One variable; numbers as floats, attributes of its type filled in."""
    name = scalar.get("name")
    typed = next(entry for entry in scalar if entry.tag != "Annotations")
    kind = str(typed.tag)
    declared = types.get(typed.get("declaredType"))
    behind = None if declared is None else declared.find(kind)

    def attribute(key: str) -> str | None:
        own: str | None = typed.get(key)
        return own if own is not None or behind is None else str(behind.get(key) or "") or None

    numeric = kind in BOUNDED
    start: float | str | None = typed.get("start")
    if start is not None and numeric:
        start = float(start)
    if start is not None and kind == "Boolean":
        start = float(true(start))
    least, most = (attribute(key) if numeric else None for key in ("min", "max"))
    port = scalar.find("Annotations/Tool[@name='resilin']/Port")
    return Variable(
        name=name,
        reference=int(scalar.get("valueReference")),
        kind=kind,
        causality=scalar.get("causality") or "local",
        unit=attribute("unit") or "",
        description=scalar.get("description") or "",
        start=start,
        least=None if least is None else float(least),
        most=None if most is None else float(most),
        port=name.rpartition(".")[0] if port is None else port.get("name"),
        order=0 if port is None else int(port.get("order", "0")),
        choices=() if behind is None else tuple(item.get("name") for item in behind),
        codes=() if behind is None else tuple(int(item.get("value", "0")) for item in behind),
        depends=depends,
        variability=scalar.get("variability") or "continuous",
    )
