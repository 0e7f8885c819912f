"""A system structure description as data: elements, connections, parameter bindings.

What a file asks for and this project cannot do is a problem with its place, never passed over:
transformations other than linear ones, elements that are not FMUs, parameter sets in other formats.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from ...errors import Problems, ScenarioError, printable
from .names import FMU, MAPPING, PARAMETERS, local, tag
from .units import declared_units

Fetch = Callable[[str], Any]
IMPLEMENTATIONS = {"any", "CoSimulation", "ModelExchange"}
"""What a component may be for; the FMU's own description decides what it is taken for."""
"""Root element of another file of the archive, by its address relative to the description."""


@dataclass(frozen=True)
class Value:
    """One parameter of a set: a number with its unit, a text, a choice, or true and false."""

    name: str
    value: float | str | bool
    kind: str
    unit: str = ""


@dataclass(frozen=True)
class Connection:
    """From one connector to another; an element is "" where the connector is the system's own.

    `converts`: whether units are to be converted.
    """

    start: tuple[str, str]
    end: tuple[str, str]
    gain: float = 1.0
    offset: float = 0.0
    converts: bool = True


@dataclass(frozen=True)
class Component:
    """An FMU of the archive, with the parameters bound to it, later ones overriding.

    `units` are those that its connectors declare, by their names.
    """

    name: str
    source: str
    values: list[Value]
    units: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class System:
    """Components and systems with their connections; `inputs` and `outputs` are its own.

    `settable` are those that may be given a value, inputs and parameters, each with its unit.
    """

    name: str
    components: list[Component]
    systems: list[System]
    connections: list[Connection]
    values: list[Value]
    inputs: list[str] = field(default_factory=list)
    settable: dict[str, str] = field(default_factory=dict)
    outputs: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Document:
    """A whole description; `start` and `stop` are those of its default experiment [s]."""

    title: str
    system: System
    start: float
    stop: float | None
    annotations: dict[str, str]


class Reader:
    """Reads one description; `where` opens each of the problems that are gathered."""

    def __init__(self, where: str, fetch: Fetch) -> None:
        self.where = where
        self.problems = Problems(where)
        self._fetch = fetch
        self._units: dict[str, str] = {}

    def document(self, root: Any) -> Document:
        """The description; `ScenarioError` with everything that cannot be taken over."""
        if root.tag != tag("ssd:SystemStructureDescription"):
            raise ScenarioError(f"{self.where}: is not a system structure description")
        version = root.get("version") or ""
        if version.partition(".")[0] not in {"1", "2"}:
            raise ScenarioError(
                f"{self.where}: SSP version {printable(version)!r} is not known here"
            )
        system = root.find(tag("ssd:System"))
        if system is None:
            raise ScenarioError(f"{self.where}: describes no system")
        self._units = declared_units(root.find(tag("ssd:Units")))
        found = self.system(system)
        start, stop = self._experiment(root.find(tag("ssd:DefaultExperiment")))
        listed = root.find(tag("ssd:Annotations"))
        annotations = {
            str(each.get("type")): "".join(each.itertext()).strip()
            for each in (listed if listed is not None else [])
            if local(each) == "Annotation"
        }
        self.problems.check()
        return Document(root.get("name") or "", found, start, stop, annotations)

    def system(self, element: Any) -> System:
        """One system with everything in it."""
        components, systems = [], []
        names: set[str] = set()
        for each in self._children(element, "ssd:Elements"):
            kind, name = local(each), each.get("name") or ""
            if name in names:
                self.problems.add(f"line {each.sourceline}", f"two elements are called {name!r}")
            names.add(name)
            if kind == "System":
                systems.append(self.system(each))
            elif kind == "Component":
                components.append(self._component(each, name))
            else:
                self.problems.add(
                    f"line {each.sourceline}",
                    f"{kind} {printable(name)!r} is not supported; connect components directly",
                )
        connectors = list(self._children(element, "ssd:Connectors"))
        return System(
            name=element.get("name") or "",
            components=components,
            systems=systems,
            connections=list(self._connections(element)),
            values=self._values(element),
            inputs=[str(c.get("name")) for c in connectors if c.get("kind") == "input"],
            settable={
                str(c.get("name")): self._unit(c)
                for c in connectors
                if c.get("kind") in {"input", "parameter", "structuralParameter", "inout"}
            },
            outputs=[str(c.get("name")) for c in connectors if c.get("kind") == "output"],
        )

    def _unit(self, connector: Any) -> str:
        """Unit that a connector's type gives, as it is defined; "" where it gives none."""
        units = [each.get("unit") for each in connector if local(each)]
        unit = next((unit for unit in units if unit), "")
        return self._units.get(unit, unit)

    def _children(self, element: Any, name: str) -> Iterator[Any]:
        """Elements under a child of this name; comments are left out."""
        for parent in element.findall(tag(name)):
            yield from (each for each in parent if local(each))

    def _component(self, element: Any, name: str) -> Component:
        line, named = f"line {element.sourceline}", f"component {printable(name)!r}"
        kind, source = element.get("type") or FMU, element.get("source") or ""
        if kind != FMU:
            self.problems.add(line, f"{named} is of type {printable(kind)}, not an FMU")
        if element.get("implementation", "any") not in IMPLEMENTATIONS:
            self.problems.add(line, f"{named} is for {element.get('implementation')} only")
        if not source:
            self.problems.add(line, f"{named} names no source")
        units = {
            str(c.get("name")): unit
            for c in self._children(element, "ssd:Connectors")
            if (unit := self._unit(c))
        }
        return Component(name, source, self._values(element), units)

    def _connections(self, element: Any) -> Iterator[Connection]:
        for each in self._children(element, "ssd:Connections"):
            gain, offset = self._transformation(each)
            yield Connection(
                start=(each.get("startElement") or "", each.get("startConnector") or ""),
                end=(each.get("endElement") or "", each.get("endConnector") or ""),
                gain=gain,
                offset=offset,
                converts=each.get("suppressUnitConversion") not in {"true", "1"},
            )

    def _transformation(self, element: Any) -> tuple[float, float]:
        for each in element:
            kind = local(each)
            if kind == "LinearTransformation":
                return self._number(each, "factor", 1.0), self._number(each, "offset", 0.0)
            if kind.endswith("Transformation"):
                self.problems.add(
                    f"line {each.sourceline}", f"{kind} is not supported, only linear ones are"
                )
        return 1.0, 0.0

    def _number(self, element: Any, key: str, usual: float) -> float:
        text = element.get(key)
        try:
            value = usual if text is None else float(text)
        except ValueError:
            value = float("nan")
        if not isfinite(value):
            shown = printable(str(text), most=40)
            self.problems.add(
                f"line {element.sourceline}", f"{key} {shown!r} is not a finite number"
            )
            return usual
        return value

    def _experiment(self, element: Any) -> tuple[float, float | None]:
        if element is None:
            return 0.0, None
        start = self._number(element, "startTime", 0.0)
        stop = None if element.get("stopTime") is None else self._number(element, "stopTime", 0.0)
        return start, stop

    def _values(self, element: Any) -> list[Value]:
        """Parameters bound to an element, in their order, mapped and prefixed."""
        found: list[Value] = []
        for binding in self._children(element, "ssd:ParameterBindings"):
            place = f"line {binding.sourceline}: parameter binding"
            if binding.get("type", PARAMETERS) != PARAMETERS:
                self.problems.add(place, f"type {printable(binding.get('type'))} is not known")
                continue
            if binding.get("sourceBase", "SSD") != "SSD":
                self.problems.add(place, "a source inside a component is not supported")
                continue
            root = self._content(binding, binding.find(tag("ssd:ParameterValues")), "ssv")
            values = [] if root is None else list(self.parameters(root))
            mapping = binding.find(tag("ssd:ParameterMapping"))
            if mapping is not None:
                values = list(self._mapped(values, mapping, place))
            prefix = binding.get("prefix") or ""
            found += [Value(prefix + v.name, v.value, v.kind, v.unit) for v in values]
        return found

    def _content(self, element: Any, inline: Any, kind: str) -> Any:
        """Root of a parameter set or mapping: inline, or in a file of the archive."""
        source = element.get("source")
        if source:
            return self._fetch(source)
        children = [each for each in (inline if inline is not None else []) if local(each)]
        if not children:
            self.problems.add(
                f"line {element.sourceline}", f"has neither a source nor anything inside ({kind})"
            )
            return None
        return children[0]

    def _mapped(self, values: list[Value], element: Any, place: str) -> Iterator[Value]:
        if element.get("type", MAPPING) != MAPPING or element.get("sourceBase", "SSD") != "SSD":
            self.problems.add(place, "this kind of parameter mapping is not supported")
            return
        root = self._content(element, element, "ssm")
        for entry in [] if root is None else root.findall(tag("ssm:MappingEntry")):
            gain, offset = self._transformation(entry)
            for value in values:
                if value.name != entry.get("source"):
                    continue
                new = value.value
                if (gain, offset) != (1.0, 0.0):
                    if isinstance(new, bool | str):
                        self.problems.add(
                            f"line {entry.sourceline}",
                            f"{printable(value.name)} is transformed but is not a number",
                        )
                        continue
                    new = gain * new + offset
                kept = entry.get("suppressUnitConversion") not in {"true", "1"}
                yield Value(str(entry.get("target")), new, value.kind, value.unit if kept else "")

    def parameters(self, root: Any) -> Iterator[Value]:
        """The parameters of a set."""
        if root.tag != tag("ssv:ParameterSet"):
            self.problems.add(
                f"line {root.sourceline}", f"{printable(local(root))} is not a parameter set"
            )
            return
        units = {**self._units, **declared_units(root.find(tag("ssv:Units")))}
        for each in self._children(root, "ssv:Parameters"):
            typed = next((t for t in each if local(t) not in {"", "Annotations"}), None)
            name = str(each.get("name"))
            if typed is None:
                continue
            kind, text = local(typed), str(typed.get("value"))
            value: float | str | bool = text
            if kind == "Boolean":
                value = text in {"true", "1"}
            elif kind not in {"String", "Enumeration"}:
                value = self._number(typed, "value", 0.0)
                if len(text.split()) > 1:
                    self.problems.add(
                        f"line {typed.sourceline}",
                        f"{printable(name)} is an array; set its elements",
                    )
            unit = typed.get("unit") or ""
            yield Value(name, value, kind, units.get(unit, unit))
