"""What an FMU says of itself: its modelDescription, read with care and checked.

The XML is parsed once, guarded (no DOCTYPE, bounded depth), validated against the schema of
FMI that fmpy carries, checked for what the schema does not see, and reduced to the few facts
that wiring and running need.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .archive import read_description
from .errors import FmuError, printable

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,200}")
DEEPEST = 64
MOST_LINED = 5000
SUPPORTED = ("2.0",)
BOUNDED = ("Real", "Integer", "Enumeration")


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU."""

    name: str
    reference: int
    kind: str
    causality: str
    unit: str
    description: str
    start: float | str | None
    least: float | None
    most: float | None
    port: str = ""
    order: int = 0
    choices: tuple[str, ...] = ()
    depends: tuple[str, ...] | None = None

    @property
    def member(self) -> str:
        """Name inside its port."""
        return self.name.removeprefix(self.port + ".") if self.port else self.name


@dataclass(frozen=True)
class Interface:
    """Variables and capabilities of an FMU."""

    path: Path
    model: str
    identifier: str
    guid: str
    tool: str
    variables: dict[str, Variable]
    rollback: bool
    variable_step: bool
    needs_tool: bool
    warnings: tuple[str, ...] = field(default=())

    def of(self, *causalities: str) -> list[Variable]:
        """Variables with one of these causalities, in the FMU's order."""
        return [v for v in self.variables.values() if v.causality in causalities]

    def port(self, name: str, causality: str) -> list[Variable]:
        """Members of a port with one causality: annotated, or sharing the prefix."""
        return [v for v in self.of(causality) if v.port == name]

    def ports(self) -> list[str]:
        """Names of all ports."""
        return sorted({v.port for v in self.of("input", "output") if v.port})


def read_interface(path: Path) -> Interface:
    """Interface of an FMU file; `FmuError` with file, line and cause where it is unfit."""
    text = read_description(path)
    root = _guarded(path, text)
    _check_version(path, root)
    problems = _against_schema(root, text)
    warnings: list[str] = []
    if not problems:
        _check_variables(root, problems, warnings)
    if problems:
        raise FmuError(f"{path}: modelDescription.xml: {problems[0]}" + _more(problems))
    return _reduced(path, root, tuple(warnings))


def _more(problems: list[str]) -> str:
    return f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""


def _guarded(path: Path, text: bytes) -> Any:
    """Root element, parsed without entities, network or bottomless nesting."""
    from lxml import etree

    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
    )
    try:
        root = etree.fromstring(text, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        doctype = any(
            "<!DOCTYPE".encode(code) in text
            for code in ("utf-8", "utf-16-le", "utf-16-be", "utf-32-le", "utf-32-be")
        )
        reason = "has a DOCTYPE: refused" if doctype else f"is not XML: {printable(str(error))}"
        raise FmuError(f"{path}: modelDescription.xml {reason}") from None
    document: Any = root.getroottree().docinfo
    if document.internalDTD is not None or document.doctype:
        raise FmuError(f"{path}: modelDescription.xml has a DOCTYPE: refused")
    depth = 0
    for event, _ in etree.iterwalk(root, events=("start", "end")):
        depth += 1 if event == "start" else -1
        if depth > DEEPEST:
            raise FmuError(f"{path}: modelDescription.xml is nested deeper than {DEEPEST}")
    return root


@functools.cache
def _schema() -> Any:
    """The schema of FMI 2.0 that comes with fmpy."""
    import fmpy
    from lxml import etree

    folder = Path(fmpy.__file__).parent / "schema" / "fmi2"
    return etree.XMLSchema(file=str(folder / "fmi2ModelDescription.xsd"))


def _against_schema(root: Any, text: bytes) -> list[str]:
    """What the schema objects to, with lines where the document is of a usual size.

    Collecting all faults takes quadratic time in their number; a parser that validates
    stops at the first, but knows no line.
    """
    from lxml import etree

    if len(root.findall("ModelVariables/ScalarVariable")) > MOST_LINED:
        parser = etree.XMLParser(schema=_schema(), resolve_entities=False, no_network=True)
        try:
            etree.fromstring(text, parser)
        except etree.XMLSyntaxError as error:
            return [f"line unknown: {printable(str(error))}"]
        return []
    schema = _schema()
    if schema.validate(root):
        return []
    return [f"line {e.line}: {printable(e.message)}" for e in schema.error_log]


def _check_version(path: Path, root: Any) -> None:
    """Refuse what is no FMI 2.0 co-simulation FMU with a sane identifier."""
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise FmuError(f"{path}: modelDescription.xml has no fmiVersion")
    if version not in SUPPORTED:
        raise FmuError(
            f"{path}: FMI version {printable(version)!r} is not supported;"
            f" use FMI {', '.join(SUPPORTED)}"
        )
    kind = root.find("CoSimulation")
    if kind is None:
        raise FmuError(f"{path}: not a co-simulation FMU; export it for co-simulation")
    identifier = kind.get("modelIdentifier") or ""
    if not IDENTIFIER.fullmatch(identifier):
        raise FmuError(f"{path}: modelIdentifier '{printable(identifier)}' is not a C identifier")


def _check_variables(root: Any, problems: list[str], warnings: list[str]) -> None:
    """Names, references, start values, bounds and units of all variables."""
    units = {unit.get("name") for unit in root.findall("UnitDefinitions/Unit")}
    types = {entry.get("name") for entry in root.findall("TypeDefinitions/SimpleType")}
    names: set[str] = set()
    references: dict[tuple[str, str], str] = {}
    scalars = root.findall("ModelVariables/ScalarVariable")
    for scalar in scalars:
        name = scalar.get("name") or ""
        where = f"line {scalar.sourceline}: variable '{printable(name)}'"
        if not name or printable(name, most=1000) != name:
            problems.append(f"{where} has an empty or unprintable name")
        if name in names:
            problems.append(f"{where} stands twice")
        names.add(name)
        for typed in scalar:
            if typed.tag not in {"Real", "Integer", "Boolean", "String", "Enumeration"}:
                continue
            key = (str(typed.tag), scalar.get("valueReference") or "")
            other = references.setdefault(key, name)
            if other != name:
                warnings.append(f"{where} is an alias of '{printable(other)}'")
            problems.extend(f"{where} {fault}" for fault in _faults(typed, units))
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
    """Whether a text is a variable's place, 1 to `count`."""
    plain = text is not None and text.isascii() and text.isdigit() and len(text) < 10
    return plain and 1 <= int(text or "0") <= count


def _faults(typed: Any, units: Iterable[str | None]) -> list[str]:
    """What is wrong with start, min, max and unit of one typed element."""
    found = []
    numbers: dict[str, float] = {}
    for key in ("start", "min", "max", "nominal"):
        text = typed.get(key)
        if text is None or typed.tag not in BOUNDED:
            continue
        try:
            numbers[key] = float(text)
        except ValueError:
            found.append(f"has {key} {printable(text)!r}, which is no number")
            continue
        if not math.isfinite(numbers[key]):
            found.append(f"has {key} {printable(text)}, which is not finite")
    if numbers.get("min", -math.inf) > numbers.get("max", math.inf):
        found.append("has min above max")
    unit = typed.get("unit")
    if unit is not None and unit not in units:
        found.append(f"has unit '{printable(unit)}', which is not defined")
    return found


def _reduced(path: Path, root: Any, warnings: tuple[str, ...]) -> Interface:
    """The facts that matter, from the tree and our annotations."""
    types = {entry.get("name"): entry for entry in root.findall("TypeDefinitions/SimpleType")}
    scalars = root.findall("ModelVariables/ScalarVariable")
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
    kind = root.find("CoSimulation")
    return Interface(
        path=path,
        model=root.get("modelName"),
        identifier=kind.get("modelIdentifier"),
        guid=root.get("guid"),
        tool=root.get("generationTool") or "",
        variables=variables,
        rollback=_true(kind.get("canGetAndSetFMUstate")),
        variable_step=_true(kind.get("canHandleVariableCommunicationStepSize")),
        needs_tool=_true(kind.get("needsExecutionTool")),
        warnings=warnings,
    )


def _variable(scalar: Any, types: dict[str, Any], depends: tuple[str, ...] | None) -> Variable:
    """One variable; numbers as floats, what its declared type says filled in."""
    name = scalar.get("name")
    typed = next(entry for entry in scalar if entry.tag != "Annotations")
    kind = str(typed.tag)
    declared = types.get(typed.get("declaredType"))
    behind = None if declared is None else declared.find(kind)

    def said(key: str) -> str | None:
        own: str | None = typed.get(key)
        return own if own is not None or behind is None else str(behind.get(key) or "") or None

    numeric = kind in BOUNDED
    start: float | str | None = typed.get("start")
    if start is not None and numeric:
        start = float(start)
    least, most = (said(key) if numeric else None for key in ("min", "max"))
    port = scalar.find("Annotations/Tool[@name='resilin']/Port")
    return Variable(
        name=name,
        reference=int(scalar.get("valueReference")),
        kind=kind,
        causality=scalar.get("causality") or "local",
        unit=said("unit") or "",
        description=scalar.get("description") or "",
        start=start,
        least=None if least is None else float(least),
        most=None if most is None else float(most),
        port=name.rpartition(".")[0] if port is None else port.get("name"),
        order=0 if port is None else int(port.get("order", "0")),
        choices=() if behind is None else tuple(item.get("name") for item in behind),
        depends=depends,
    )


def _true(value: Any) -> bool:
    return value in {"true", "1"}
