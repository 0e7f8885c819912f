"""What an FMU says of itself: its modelDescription, read with care and checked.

The XML is guarded first (no DOCTYPE, bounded depth), then validated and parsed by fmpy, then
reduced to the few facts that wiring and running need.
"""

from __future__ import annotations

import io
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
    problems: list[str] = []
    warnings: list[str] = []
    _check_variables(root, problems, warnings)
    if problems:
        raise FmuError(f"{path}: modelDescription.xml: {problems[0]}" + _more(problems))
    return _reduced(path, root, _parsed(path, text), tuple(warnings))


def _more(problems: list[str]) -> str:
    return f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""


def _guarded(path: Path, text: bytes) -> Any:
    """Root element, parsed without entities, network or bottomless nesting."""
    from lxml import etree

    marker = "<!DOCTYPE"
    if any(marker.encode(code) in text for code in ("utf-8", "utf-16-le", "utf-16-be")):
        raise FmuError(f"{path}: modelDescription.xml has a DOCTYPE: refused")
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=False)
    try:
        root = etree.fromstring(text, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        message = printable(str(error))
        raise FmuError(f"{path}: modelDescription.xml is not XML: {message}") from None
    depth = 0
    for event, _ in etree.iterwalk(root, events=("start", "end")):
        depth += 1 if event == "start" else -1
        if depth > DEEPEST:
            raise FmuError(f"{path}: modelDescription.xml is nested deeper than {DEEPEST}")
    return root


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
    for unknown in root.iterfind("ModelStructure//Unknown"):
        indices = [unknown.get("index"), *(unknown.get("dependencies") or "").split()]
        for index in indices:
            if not (index and index.isdigit() and 1 <= int(index) <= len(scalars)):
                line = unknown.sourceline
                problems.append(f"line {line}: ModelStructure names no variable {index!r}")


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


def _parsed(path: Path, text: bytes) -> Any:
    """Model description as fmpy validates and parses it."""
    import zipfile

    from fmpy.model_description import ValidationError, read_model_description

    alone = io.BytesIO()
    with zipfile.ZipFile(alone, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    try:
        return read_model_description(alone)
    except ValidationError as error:
        problem = printable(str(error.problems[0]))
        raise FmuError(f"{path}: modelDescription.xml: {problem}" + _more(error.problems)) from None
    except Exception as error:
        problem = printable(str(error))
        raise FmuError(f"{path}: modelDescription.xml cannot be read: {problem}") from None


def _reduced(path: Path, root: Any, parsed: Any, warnings: tuple[str, ...]) -> Interface:
    """The facts that matter, from fmpy's description and our annotations."""
    ports: dict[str, tuple[str, int]] = {}
    for scalar in root.findall("ModelVariables/ScalarVariable"):
        name = scalar.get("name")
        port = scalar.find("Annotations/Tool[@name='resilin']/Port")
        prefix = name.rpartition(".")[0]
        ports[name] = (prefix, 0) if port is None else (port.get("name"), int(port.get("order", 0)))
    depends = {
        unknown.variable.name: (
            None
            if unknown.dependencies is None
            else tuple(v.name for v in unknown.dependencies if v.causality == "input")
        )
        for unknown in parsed.outputs
    }
    variables = {
        v.name: _variable(v, *ports[v.name], depends.get(v.name)) for v in parsed.modelVariables
    }
    kind = parsed.coSimulation
    return Interface(
        path=path,
        model=parsed.modelName,
        identifier=kind.modelIdentifier,
        guid=parsed.guid,
        variables=variables,
        rollback=_true(kind.canGetAndSetFMUstate),
        variable_step=_true(kind.canHandleVariableCommunicationStepSize),
        needs_tool=_true(kind.needsExecutionTool),
        warnings=warnings,
    )


def _variable(v: Any, port: str, order: int, depends: tuple[str, ...] | None) -> Variable:
    """One variable; numbers as floats, declared types resolved."""
    declared = v.declaredType
    unit = v.unit or (declared.unit if declared is not None else None)
    items = declared.items if declared is not None and declared.items else []
    numeric = v.type in BOUNDED
    start: float | str | None = v.start
    if start is not None and numeric:
        start = float(start)
    return Variable(
        name=v.name,
        reference=int(v.valueReference),
        kind=v.type,
        causality=v.causality,
        unit=unit or "",
        description=v.description or "",
        start=start,
        least=float(v.min) if numeric and v.min is not None else None,
        most=float(v.max) if numeric and v.max is not None else None,
        port=port,
        order=order,
        choices=tuple(item.name for item in items),
        depends=depends,
    )


def _true(value: Any) -> bool:
    return value in {True, "true", "1"}
