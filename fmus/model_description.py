"""The modelDescription of a part: FMI 2.0 co-simulation XML with units, bounds and structure."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from .part import Part, Variable
from .quantity import Quantity
from .units import exponents

CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}

NATIVE = {"needsExecutionTool": "false", "providesDirectionalDerivative": "true"}
"""Where a native FMU can do more."""

LOG_CATEGORIES = {
    "logStatusWarning": "What the part reports and survives.",
    "logStatusError": "What made a call fail: component, time and cause.",
}


PROVENANCE = "; provenance: "
"""Between the meaning of a parameter and where its number comes from, in its description."""


def model_description(
    part: Part,
    identifier: str,
    guid: str,
    version: str,
    variables: list[Variable],
    *,
    sources: str = "",
    native: bool = False,
) -> Element:
    """XML tree of `part`, exported under the class name `identifier`.

    `variables` are the part's, with the start values of this build. `sources` is the digest that
    both kinds of FMU share where they are made of the same sources and start values. A `native` FMU
    needs no tool, and provides directional derivatives.
    Every variable has a unit and a description. Outputs are `calculated`, carry no start
    value, name the inputs they follow directly, and stand in InitialUnknowns too. The
    annotation of a port's member holds its order in the law (0 value, 1 affine,
    2 curvature), so that a master can choose how much of a port it connects.
    """
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=identifier,
        guid=guid,
        description=part.description,
        version=version,
        generationTool="Resilin" if native else "Resilin with PythonFMU",
        variableNamingConvention="structured",
    )
    root.attrib |= part.origin
    own = {"needsExecutionTool": "true"} | CAPABILITIES | (NATIVE if native else {})
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **own})
    add_unit_definitions(root, variables)
    _type_definitions(root, part, variables)
    categories = SubElement(root, "LogCategories")
    for name, meaning in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=meaning)
    SubElement(root, "DefaultExperiment", startTime="0.0", stepSize=repr(part.step))
    if sources:
        annotations = SubElement(root, "VendorAnnotations")
        tool = SubElement(annotations, "Tool", name="resilin")
        SubElement(tool, "Sources", digest=sources)
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        listed.append(_scalar(part, reference, variable))
    _structure(root, part, variables)
    return root


def add_unit_definitions(root: Element, variables: list[Variable]) -> None:
    """Add each unit that occurs, once, with its base-unit exponents."""
    definitions = SubElement(root, "UnitDefinitions")
    for name in sorted({variable.quantity.unit for variable in variables} - {""}):
        unit = SubElement(definitions, "Unit", name=name)
        powers = {base: str(power) for base, power in exponents(name).items()}
        SubElement(unit, "BaseUnit", powers)


def _type_definitions(root: Element, part: Part, variables: list[Variable]) -> None:
    """Add one simple type per enumeration; nothing where the part has none."""
    choosing = [variable for variable in variables if variable.kind == "Enumeration"]
    if not choosing:
        return
    definitions = SubElement(root, "TypeDefinitions")
    for variable in choosing:
        simple = SubElement(definitions, "SimpleType", name=type_name(part, variable))
        items = SubElement(simple, "Enumeration")
        for value, choice in enumerate(variable.quantity.choices, start=1):
            SubElement(items, "Item", name=choice, value=str(value))


def type_name(part: Part, variable: Variable) -> str:
    """Name of the type of an enumeration."""
    return f"{part.name}.{variable.name}"


def _scalar(part: Part, reference: int, variable: Variable) -> Element:
    """One ScalarVariable with type, bounds and, in a port, its order in the law."""
    quantity = variable.quantity
    scalar = Element(
        "ScalarVariable",
        name=variable.name,
        valueReference=str(reference),
        description=described(quantity),
        causality=variable.causality,
        variability=variability(variable),
        initial="calculated" if variable.causality == "output" else "exact",
    )
    if variable.causality == "input":
        del scalar.attrib["initial"]
    typed = SubElement(scalar, variable.kind)
    if variable.kind == "Enumeration":
        typed.set("declaredType", type_name(part, variable))
    else:
        if quantity.unit:
            typed.set("unit", quantity.unit)
        if quantity.least is not None:
            typed.set("min", repr(quantity.least))
        if quantity.most is not None:
            typed.set("max", repr(quantity.most))
    if variable.causality != "output":
        exact = variable.kind == "Real"
        typed.set("start", repr(variable.start) if exact else str(int(variable.start)))
    if quantity.port:
        annotations = SubElement(scalar, "Annotations")
        tool = SubElement(annotations, "Tool", name="resilin")
        SubElement(tool, "Port", name=quantity.port, order=str(quantity.order))
    return scalar


def described(quantity: Quantity) -> str:
    """What a variable means and, of a parameter, where its number comes from."""
    return (
        f"{quantity.meaning}{PROVENANCE}{quantity.source}" if quantity.source else quantity.meaning
    )


def variability(variable: Variable) -> str:
    """When a variable may change, in the words of FMI."""
    if variable.causality != "parameter":
        return "discrete" if variable.quantity.discrete else "continuous"
    return "tunable" if variable.quantity.tunable else "fixed"


def _structure(root: Element, part: Part, variables: list[Variable]) -> None:
    """Add Outputs and InitialUnknowns with their dependencies.

    At initialisation every output may follow every input and parameter, since the initial
    state does; that is FMI's default where `dependencies` is left out.
    """
    place = {variable.name: str(index) for index, variable in enumerate(variables, start=1)}
    structure = SubElement(root, "ModelStructure")
    outputs = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    for variable in variables:
        if variable.causality != "output":
            continue
        known = [place[source.name] for source in part.dependencies(variable)]
        SubElement(outputs, "Unknown", index=place[variable.name], dependencies=" ".join(known))
        SubElement(unknowns, "Unknown", index=place[variable.name])
