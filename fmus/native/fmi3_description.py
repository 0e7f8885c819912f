"""The modelDescription of a part for FMI 3.0: the variables of FMI 2.0, and the time."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..model_description import (
    LOG_CATEGORIES,
    add_unit_definitions,
    described,
    type_name,
    variability,
)
from ..part import Part, Variable

CAPABILITIES = {
    "needsExecutionTool": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesDirectionalDerivatives": "true",
    "canHandleVariableCommunicationStepSize": "true",
}
EVENTS = {"hasEventMode": "true", "mightReturnEarlyFromDoStep": "true"}
"""Of a part that announces the edges of its drive."""
EVENT = "next_event_time"
"""The output that announces them."""


def model_description(
    part: Part,
    identifier: str,
    token: str,
    version: str,
    variables: list[Variable],
    *,
    sources: str,
) -> Element:
    """XML tree of `part`: value references, starts, bounds and dependencies are those of FMI 2.0.

    What FMI 2.0 keeps in vendor annotations of a variable stands in an annotation of the type
    `resilin`; the terminals of FMI 3.0 are in a file of their own.
    """
    root = Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=identifier,
        instantiationToken=token,
        description=part.description,
        version=version,
        generationTool="Resilin",
        variableNamingConvention="structured",
    )
    root.attrib |= part.origin
    events = EVENTS if any(v.name == EVENT for v in variables) else {}
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **CAPABILITIES, **events})
    add_unit_definitions(root, [*variables])
    _type_definitions(root, part, variables)
    categories = SubElement(root, "LogCategories")
    for name, meaning in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=meaning)
    SubElement(root, "DefaultExperiment", startTime="0.0", stepSize=repr(part.step))
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        listed.append(_variable(part, reference, variable))
    SubElement(
        listed,
        "Float64",
        name="time",
        valueReference=str(len(variables)),
        causality="independent",
        variability="continuous",
        description="Simulation time",
    )
    _structure(root, part, variables)
    annotations = SubElement(root, "Annotations")
    own = SubElement(annotations, "Annotation", type="resilin")
    SubElement(own, "Sources", digest=sources)
    return root


def _type_definitions(root: Element, part: Part, variables: list[Variable]) -> None:
    choosing = [variable for variable in variables if variable.kind == "Enumeration"]
    if not choosing:
        return
    definitions = SubElement(root, "TypeDefinitions")
    for variable in choosing:
        made = SubElement(definitions, "EnumerationType", name=type_name(part, variable))
        for value, choice in enumerate(variable.quantity.choices, start=1):
            SubElement(made, "Item", name=choice, value=str(value))


def _variable(part: Part, reference: int, variable: Variable) -> Element:
    quantity = variable.quantity
    chosen = variable.kind == "Enumeration"
    entry = Element(
        "Enumeration" if chosen else "Float64",
        name=variable.name,
        valueReference=str(reference),
        description=described(quantity),
        causality=variable.causality,
        variability=variability(variable),
    )
    if chosen:
        entry.set("declaredType", type_name(part, variable))
    else:
        for key, given in (("min", quantity.least), ("max", quantity.most)):
            if given is not None:
                entry.set(key, repr(given))
        if quantity.unit:
            entry.set("unit", quantity.unit)
    if variable.causality == "output":
        entry.set("initial", "calculated")
    else:
        entry.set("start", str(int(variable.start)) if chosen else repr(variable.start))
    if quantity.port:
        annotations = SubElement(entry, "Annotations")
        own = SubElement(annotations, "Annotation", type="resilin")
        SubElement(own, "Port", name=quantity.port, order=str(quantity.order))
    return entry


def _structure(root: Element, part: Part, variables: list[Variable]) -> None:
    """Outputs with the inputs they follow; at initialisation they may follow everything."""
    place = {variable.name: str(reference) for reference, variable in enumerate(variables)}
    structure = SubElement(root, "ModelStructure")
    outputs = [variable for variable in variables if variable.causality == "output"]
    for output in outputs:
        known = " ".join(place[source.name] for source in part.dependencies(output))
        SubElement(structure, "Output", valueReference=place[output.name], dependencies=known)
    for output in outputs:
        SubElement(structure, "InitialUnknown", valueReference=place[output.name])
