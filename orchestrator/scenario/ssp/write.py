"""A checked scenario as an SSP archive: structure, parameters and FMUs, for other tools and back.

Connectors are the variables that are wired, held, set or recorded; all others of an FMU keep their
start values, as they do here. What SSP has no place for (step, master, actions, faults, metrics)
goes into an annotation of our own, which other tools pass over and `resilin run` reads.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, register_namespace, tostring

from ...errors import ScenarioError
from ...fmi.archive import STRUCTURE
from ...fmi.description import Variable
from ...report.files import written_whole
from ..plan import Plan
from ..schema import AUTO
from .names import ANNOTATION, FMU, NAMESPACES, tag
from .units import _defined, _units

VERSIONS = ("1.0", "2.0")


OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
"""Namespace in which libcosim looks for the step."""


DEFAULT = "initialValues"
"""Name of the parameter set that Ecos takes where none is chosen."""


KINDS = {"Real": "Real", "Float64": "Real", "Float32": "Real", "Boolean": "Boolean"}


EPOCH = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class Package:
    """What goes into an archive: the plan, other FMUs for some components, further sets.

    `files` hold recordings as FMUs, and parts with choices built into them; `built_in` names these
    choices, `component.parameter`. `sets` are start values in the FMUs' units, by name of the set
    and `component.parameter`.
    """

    plan: Plan
    files: Mapping[str, Path]
    built_in: frozenset[str] = frozenset()
    sets: Mapping[str, Mapping[str, float | str]] = field(default_factory=dict)
    version: str = "1.0"

    @property
    def starts(self) -> dict[str, float | str]:
        """Start values and held inputs by `component.variable`, less what is built in.

        A choice that the FMU starts with by itself is left out too: few tools can set it.
        """
        found: dict[str, float | str] = {
            f"{component}.{name}": value
            for component, values in self.plan.starts.items()
            for name, value in values.items()
            if not _by_itself(self.plan.interfaces[component].variables[name], value)
        }
        return {k: v for k, v in {**found, **self.plan.held}.items() if k not in self.built_in}


def _by_itself(variable: Variable, value: float | str) -> bool:
    return variable.kind == "Enumeration" and variable.start == value


def write_ssp(package: Package, path: Path) -> list[str]:
    """Write the archive, whole or not at all; remarks on what other tools do not read.

    Raises :class:`ScenarioError` where a component has no FMU, :class:`OutputError` where the file
    cannot be written.
    """
    for prefix, namespace in {**NAMESPACES, "osp": OSP, "resilin": ANNOTATION}.items():
        register_namespace(prefix, namespace)
    sources = _sources(package)
    texts = {STRUCTURE: _text(_description(package, sources))}
    texts["resources/parameters.ssv"] = _text(_set(package, "parameters", package.starts))
    for name, values in package.sets.items():
        texts[f"resources/{name}.ssv"] = _text(_set(package, name, values))
    with (
        written_whole(path) as waiting,
        zipfile.ZipFile(waiting, "w", zipfile.ZIP_DEFLATED) as archive,
    ):
        for name, text in texts.items():
            archive.writestr(_entry(name), text)
        for name, file in sources.values():
            if name not in archive.namelist():
                archive.writestr(_entry(name), file.read_bytes())
    return list(_remarks(package))


def _entry(name: str) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, EPOCH)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.external_attr = 0o644 << 16
    return info


def _remarks(package: Package) -> Iterator[str]:
    """What of a scenario no other tool reads from the archive, or few do."""
    plan = package.plan
    kinds = {key: _variable(plan, key).kind for key in package.starts}
    if choices := sorted(key for key, kind in kinds.items() if kind == "Enumeration"):
        yield (
            f"{', '.join(choices)}: set as enumerations, which few other tools read from SSP; an"
            " FMU that starts with the choice needs none"
        )
    if plan.actions:
        yield f"{len(plan.actions)} timed actions: SSP has none, other tools do not carry them out"
    if plan.scenario.time.step == AUTO:
        yield 'step = "auto" is for runs here: give other tools a step of their own'
    if plan.faults:
        yield f"{len(plan.faults)} injected faults: SSP has none, other tools do not inject them"
    if any(c.input.order for c in plan.connections):
        yield (
            "laws pass by ordinary connections: any tool that connects them all has the benefit, a"
            " sequential one most"
        )


def _sources(package: Package) -> dict[str, tuple[str, Path]]:
    """Name in the archive and file of each component's FMU; one file serves all that are alike."""
    made: dict[str, tuple[str, Path]] = {}
    taken: dict[str, Path] = {}
    for name in package.plan.scenario.components:
        if name in package.files:
            file = package.files[name]
        elif name in package.plan.recordings:
            raise ScenarioError(
                f"{name}: is a recording, which SSP cannot hold; make it an FMU first"
            )
        else:
            file = package.plan.interfaces[name].path
        entry = f"resources/{file.name}"
        if taken.setdefault(entry, file) != file:
            entry = f"resources/{name}_{file.name}"
            taken[entry] = file
        made[name] = (entry, file)
    return made


def _text(root: Element) -> bytes:
    indent(root)
    return bytes(tostring(root, encoding="UTF-8", xml_declaration=True))


def _description(package: Package, sources: Mapping[str, tuple[str, Path]]) -> Element:
    plan = package.plan
    title = plan.scenario.title or plan.path.stem
    root = Element(
        tag("ssd:SystemStructureDescription"), version=package.version, name=title,
        generationTool="Resilin",
    )  # fmt: skip
    system = SubElement(root, tag("ssd:System"), name="system")
    elements = SubElement(system, tag("ssd:Elements"))
    for name in plan.order:
        made = SubElement(
            elements, tag("ssd:Component"), name=name, type=FMU, source=sources[name][0]
        )
        _connectors(made, package, name)
        _bound(made, package, name)
    connections = SubElement(system, tag("ssd:Connections"))
    for c in plan.connections:
        joint = SubElement(
            connections, tag("ssd:Connection"), startElement=c.source,
            startConnector=c.output.name, endElement=c.target, endConnector=c.input.name,
        )  # fmt: skip
        if c.gain != 1.0 or c.offset != 0.0:
            joint.set("suppressUnitConversion", "true")
            linear = SubElement(joint, tag("ssc:LinearTransformation"), factor=repr(c.gain))
            linear.set("offset", repr(c.offset))
    if not plan.connections:
        system.remove(connections)
    _enumerations(root, package)
    _units(root, {v.unit for _, v in _used(package)} - {""})
    experiment = SubElement(root, tag("ssd:DefaultExperiment"))
    experiment.set("startTime", repr(plan.grid.start))
    experiment.set("stopTime", repr(plan.grid.stop))
    if plan.scenario.time.step != AUTO:
        _step(experiment, plan)
    annotations = SubElement(root, tag("ssd:Annotations"))
    SubElement(annotations, tag("ssc:Annotation"), type=ANNOTATION).append(_annotation(plan))
    return root


def _variable(plan: Plan, key: str) -> Variable:
    component, _, name = key.partition(".")
    return plan.interfaces[component].variables[name]


def _used(package: Package) -> list[tuple[str, Variable]]:
    """Variables that take part: wired, held, set or recorded."""
    plan = package.plan
    found: dict[tuple[str, str], Variable] = {}
    for c in plan.connections:
        found[c.source, c.output.name] = c.output
        found[c.target, c.input.name] = c.input
    for key in package.starts:
        component, _, name = key.partition(".")
        found[component, name] = _variable(plan, key)
    for component, variable in [*plan.records, *plan.texts]:
        if variable.causality == "output":
            found[component, variable.name] = variable
    return [(component, variable) for (component, _), variable in found.items()]


def _connectors(element: Element, package: Package, name: str) -> None:
    listed = SubElement(element, tag("ssd:Connectors"))
    for owner, variable in _used(package):
        if owner != name:
            continue
        made = SubElement(
            listed, tag("ssd:Connector"), name=variable.name, kind=_causality(variable)
        )
        kind = _kind(variable)
        typed = SubElement(made, tag(f"ssc:{kind}"))
        if kind == "Real" and variable.unit:
            typed.set("unit", variable.unit)
        if kind == "Enumeration":
            typed.set("name", _enumeration(name, variable))
    if not len(listed):
        element.remove(listed)


def _causality(variable: Variable) -> str:
    return variable.causality if variable.causality in {"input", "output"} else "parameter"


def _kind(variable: Variable) -> str:
    if variable.kind in {"Enumeration", "String"}:
        return variable.kind
    return KINDS.get(variable.kind, "Integer")


def _enumeration(component: str, variable: Variable) -> str:
    return f"{component}.{variable.name}"


def _bound(element: Element, package: Package, name: str) -> None:
    """Start values of a component, bound to it in place."""
    prefix = f"{name}."
    values = {k: v for k, v in package.starts.items() if k.startswith(prefix)}
    if not values:
        return
    bindings = SubElement(element, tag("ssd:ParameterBindings"))
    binding = SubElement(bindings, tag("ssd:ParameterBinding"))
    inside = SubElement(binding, tag("ssd:ParameterValues"))
    inside.append(_set(package, DEFAULT, values, prefix))


def _set(
    package: Package, title: str, values: Mapping[str, float | str], prefix: str = ""
) -> Element:
    """A parameter set; its names are written without `prefix`."""
    root = Element(tag("ssv:ParameterSet"), version=package.version, name=title)
    listed = SubElement(root, tag("ssv:Parameters"))
    used: dict[str, Variable] = {}
    for key, value in values.items():
        component = key.partition(".")[0]
        variable = _variable(package.plan, key)
        made = SubElement(listed, tag("ssv:Parameter"), name=key.removeprefix(prefix))
        kind = _kind(variable)
        typed = SubElement(made, tag(f"ssv:{kind}"), value=_written(variable, kind, value))
        if kind == "Real" and variable.unit:
            typed.set("unit", variable.unit)
        if kind == "Enumeration":
            typed.set("name", _enumeration(component, variable))
        used[key] = variable
    chosen = [(k.partition(".")[0], v) for k, v in used.items() if v.kind == "Enumeration"]
    if chosen:
        _enumerated(SubElement(root, tag("ssv:Enumerations")), chosen)
    if units := {v.unit for v in used.values() if _kind(v) == "Real"} - {""}:
        _defined(SubElement(root, tag("ssv:Units")), units)
    return root


def _written(variable: Variable, kind: str, value: float | str) -> str:
    if kind == "Enumeration":
        return variable.choices[variable.codes.index(int(value))]
    if kind == "Boolean":
        return "true" if float(value) else "false"
    if kind == "Integer":
        return str(int(value))
    return repr(float(value)) if kind == "Real" else str(value)


def _enumerations(root: Element, package: Package) -> None:
    chosen = [(name, v) for name, v in _used(package) if v.kind == "Enumeration"]
    if chosen:
        _enumerated(SubElement(root, tag("ssd:Enumerations")), chosen)


def _enumerated(listed: Element, chosen: list[tuple[str, Variable]]) -> None:
    for component, variable in chosen:
        made = SubElement(listed, tag("ssc:Enumeration"), name=_enumeration(component, variable))
        for choice, code in zip(variable.choices, variable.codes, strict=True):
            SubElement(made, tag("ssc:Item"), name=choice, value=str(code))


def _step(experiment: Element, plan: Plan) -> None:
    """The communication step where libcosim looks for it."""
    annotations = SubElement(experiment, tag("ssd:Annotations"))
    annotation = SubElement(annotations, tag("ssc:Annotation"), type="com.opensimulationplatform")
    algorithm = SubElement(annotation, f"{{{OSP}}}Algorithm")
    SubElement(algorithm, f"{{{OSP}}}FixedStepAlgorithm", baseStepSize=repr(plan.grid.step))


def _annotation(plan: Plan) -> Element:
    """Tables of a scenario beside its structure, as JSON."""
    scenario = plan.scenario
    models = {
        "time": scenario.time,
        "master": scenario.master.model_copy(update={"order": plan.order}),
        "record": scenario.record,
        "metrics": scenario.metrics,
    }
    tables: dict[str, Any] = {
        name: table.model_dump(mode="json", by_alias=True, exclude_unset=True)
        for name, table in models.items()
    }
    if plan.step_reason:
        tables["time"]["step"] = plan.grid.step
    for name, items in (("actions", scenario.actions), ("faults", scenario.faults)):
        tables[name] = [i.model_dump(mode="json", exclude_unset=True) for i in items]
    element = Element(f"{{{ANNOTATION}}}scenario")
    element.text = json.dumps(tables)
    return element
