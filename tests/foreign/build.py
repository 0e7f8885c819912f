"""Foreign FMUs: the models of foreign.c, compiled and packed as FMI 2.0 or FMI 3.0."""

from __future__ import annotations

import functools
import json
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import fmpy

from fmus.units import exponents
from tests.foreign.models import CHOICES, FAULTS, MODELS, Model, Start, Variable, named

SOURCE = Path(__file__).with_name("foreign.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
TYPE = "Pace"
FMI_2 = {"Float64": "Real", "Int32": "Integer"}
ENUMERATION_IN_C = {2: "Int32", 3: "Int64"}
FLAGS = (
    "-std=gnu2x",
    "-O1",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",
    "-fno-sanitize=undefined",
    "-Wall",
    "-Werror",
)


def foreign(
    model: str,
    into: Path,
    *,
    version: int = 2,
    rollback: bool = True,
    forgetful: bool = False,
    variable_step: bool = True,
    once: bool = False,
    interpolates: bool = False,
    fault: int = 0,
    library: str | None = None,
    name: str | None = None,
) -> Path:
    """Build one of `MODELS` into a folder and return its .fmu.

    `rollback`, `variable_step` and `once` are both declared and enforced; so is, of FMI 2,
    `interpolates`, with which outputs have rates too. A `forgetful` one does not go back to a saved
    state, though it says so; `fault` is the start value of FAULTY's parameter. `library` is the
    file name of the shared library, `name` the stem of the .fmu; both follow from the
    modelIdentifier by default.
    """
    if model not in MODELS or version not in (2, 3):
        raise ValueError(f"no {model} for FMI {version}; there are {', '.join(MODELS)}")
    if fault not in (FAULTS if model == "FAULTY" else (0,)):
        raise ValueError(f"{model} has no fault {fault}")
    facts = named(model, version)
    options = {
        "rollback": rollback,
        "variable_step": variable_step,
        "once": once,
        "interpolates": interpolates,
    }
    describe = _description_2 if version == 2 else _description_3
    root = describe(facts, fault, **options)
    indent(root)
    platform = fmpy.platform if version == 2 else fmpy.platform_tuple
    file = library or facts.identifier + fmpy.sharedLibraryExtension
    into.mkdir(parents=True, exist_ok=True)
    path = into / f"{name or facts.identifier}.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        text = tostring(root, encoding="UTF-8", xml_declaration=True)
        archive.writestr("modelDescription.xml", text)
        code = _compiled(model, version, fault, forgetful=forgetful, **options)
        archive.writestr(f"binaries/{platform}/{file}", code)
    return path


@functools.cache
def _compiled(
    model: str,
    version: int,
    fault: int,
    *,
    forgetful: bool,
    rollback: bool,
    variable_step: bool,
    once: bool,
    interpolates: bool,
) -> bytes:
    """The shared library of a model; built once in a session for each set of options."""
    switches = {
        "ROLLBACK": rollback,
        "FORGETFUL": forgetful,
        "VARIABLE_STEP": variable_step,
        "ONCE": once,
        "INTERPOLATES": interpolates,
    }
    macros = [f"MODEL_{model}", f"FMI_VERSION={version}", f"FAULT={fault}"]
    macros += [macro for macro, wanted in switches.items() if wanted]
    with tempfile.TemporaryDirectory() as folder:
        table = _table(named(model, version), version, fault)
        Path(folder, "variables.h").write_text(table, encoding="utf-8")
        return compiled(SOURCE, macros, Path(folder))


def compiled(source: Path, macros: list[str], folder: Path) -> bytes:
    """The shared library of a source with these macros; headers are looked for in the folder."""
    target = folder / "library"
    command = [*_compiler(), *FLAGS, *(f"-D{macro}" for macro in macros)]
    command += [f"-I{HEADERS}", f"-I{folder}", str(source), "-o", str(target), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}\n{done.stderr}")
    return target.read_bytes()


def _compiler() -> list[str]:
    """Command of a C compiler: the system's, else the one of the package ziglang."""
    for command in ("cc", "gcc"):
        if shutil.which(command):
            return [command]
    return [sys.executable, "-m", "ziglang", "cc"]


def _table(facts: Model, version: int, fault: int) -> str:
    """The header variables.h that foreign.c is compiled with."""
    lines = [f'#define TOKEN "{facts.token}"', "#define VARIABLES(V) \\"]
    for variable in facts.variables:
        name = variable.name.replace(".", "_")
        kind = ENUMERATION_IN_C[version] if variable.kind == "Enumeration" else variable.kind
        length = functools.reduce(int.__mul__, variable.shape, 1)
        start = _in_c(kind, _start(variable, fault))
        lines.append(f"    V({name}, {kind}, {length}, {_access(variable)}, {start}) \\")
    return "\n".join(lines) + "\n\n"


def _access(variable: Variable) -> str:
    """When the host may set a variable, by the names of foreign.c."""
    if variable.causality not in {"input", "parameter"} and not variable.exact:
        return "NEVER"
    return "EARLY" if variable.exact or variable.variability == "fixed" else "ALWAYS"


def _in_c(kind: str, start: Start | None) -> str:
    """Initialiser of one cell."""
    if start is None:
        return "{{0}}"
    if isinstance(start, str):
        return f"{{.{kind} = {json.dumps(start, ensure_ascii=False)}}}"
    values = start if isinstance(start, tuple) else (start,)
    return f"{{.{kind} = {{{', '.join(_literal(value) for value in values)}}}}}"


def _literal(value: float | int | bool) -> str:
    """A number as both C and XML write it."""
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _start(variable: Variable, fault: int) -> Start | None:
    """Start value in this build; none where a variable is calculated."""
    if variable.causality in {"output", "local", "independent"} and not variable.exact:
        return None
    return fault if variable.name == "fault" else variable.start


def _in_xml(start: Start) -> str:
    if isinstance(start, str):
        return start
    values = start if isinstance(start, tuple) else (start,)
    return " ".join(_literal(value) for value in values)


def _truth(value: bool) -> str:
    return _literal(value)


def _head(root: Element, facts: Model, kind: str, capabilities: dict[str, str]) -> None:
    """Elements that both versions write in the same way, up to the units of measure."""
    root.set("modelName", facts.name)
    root.set("description", facts.description)
    root.set("generationTool", "foreign.c")
    root.set("variableNamingConvention", "structured")
    SubElement(root, kind, {"modelIdentifier": facts.identifier, **capabilities})
    units = sorted({variable.unit for variable in facts.variables if variable.unit})
    if units:
        definitions = SubElement(root, "UnitDefinitions")
    for name in units:
        powers = {base: str(power) for base, power in exponents(name).items()}
        SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit", powers)


def _items(enumeration: Element) -> None:
    for value, choice in enumerate(CHOICES, start=1):
        SubElement(enumeration, "Item", name=choice, value=str(value))


def _middle(root: Element) -> Element:
    """Log categories and default experiment; returns the empty list of variables."""
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusWarning", description="What is survived")
    SubElement(categories, "Category", name="logStatusError", description="What makes calls fail")
    SubElement(root, "DefaultExperiment", startTime="0.0", stepSize="0.01")
    return SubElement(root, "ModelVariables")


def _common(variable: Variable, reference: int) -> dict[str, str]:
    """Attributes of a variable that both versions write in the same way."""
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality in {"output", "parameter"}:
        calculated = variable.causality == "output" and not variable.exact
        initial = "calculated" if calculated else "exact"
        attributes["initial"] = initial
    return attributes


def _bounds(variable: Variable) -> dict[str, str]:
    """Unit, type and bounds."""
    limits = {"min": variable.least, "max": variable.most}
    attributes = {key: repr(limit) for key, limit in limits.items() if limit is not None}
    if variable.unit:
        attributes["unit"] = variable.unit
    if variable.kind == "Enumeration":
        attributes["declaredType"] = TYPE
    return attributes


def _enumerates(facts: Model) -> bool:
    return any(variable.kind == "Enumeration" for variable in facts.variables)


def _description_2(
    facts: Model, fault: int, *, rollback: bool, variable_step: bool, once: bool, interpolates: bool
) -> Element:
    """The modelDescription of FMI 2.0; members of ports are annotated with their order."""
    root = Element("fmiModelDescription", fmiVersion="2.0", guid=facts.token)
    capabilities = {
        "canHandleVariableCommunicationStepSize": _truth(variable_step),
        "canBeInstantiatedOnlyOncePerProcess": _truth(once),
        "canInterpolateInputs": _truth(interpolates),
        "maxOutputDerivativeOrder": str(int(interpolates)),
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": _truth(rollback),
    }
    _head(root, facts, "CoSimulation", capabilities)
    if _enumerates(facts):
        simple = SubElement(SubElement(root, "TypeDefinitions"), "SimpleType", name=TYPE)
        _items(SubElement(simple, "Enumeration"))
    listed = _middle(root)
    for reference, variable in enumerate(facts.variables):
        scalar = SubElement(listed, "ScalarVariable", _common(variable, reference))
        kind = FMI_2.get(variable.kind, variable.kind)
        typed = SubElement(scalar, kind, _bounds(variable))
        start = _start(variable, fault)
        if start is not None:
            typed.set("start", _in_xml(start))
        if variable.port:
            tool = SubElement(SubElement(scalar, "Annotations"), "Tool", name="resilin")
            SubElement(tool, "Port", name=variable.port, order=str(variable.order))
    structure = SubElement(root, "ModelStructure")
    outputs = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    for place, variable in enumerate(facts.variables, start=1):
        if variable.causality == "output":
            known = " ".join(str(facts.reference(name) + 1) for name in variable.follows)
            SubElement(outputs, "Unknown", index=str(place), dependencies=known)
            if not variable.exact:
                SubElement(unknowns, "Unknown", index=str(place))
    return root


def _description_3(
    facts: Model, fault: int, *, rollback: bool, variable_step: bool, once: bool, interpolates: bool
) -> Element:
    """The modelDescription of FMI 3.0, without annotations; its inputs have no derivatives."""
    del interpolates
    root = Element("fmiModelDescription", fmiVersion="3.0", instantiationToken=facts.token)
    capabilities = {
        "canHandleVariableCommunicationStepSize": _truth(variable_step),
        "canBeInstantiatedOnlyOncePerProcess": _truth(once),
        "canGetAndSetFMUState": _truth(rollback),
    }
    _head(root, facts, "CoSimulation", capabilities)
    if _enumerates(facts):
        definitions = SubElement(root, "TypeDefinitions")
        _items(SubElement(definitions, "EnumerationType", name=TYPE))
    listed = _middle(root)
    for reference, variable in enumerate(facts.variables):
        attributes = {**_common(variable, reference), **_bounds(variable)}
        element = SubElement(listed, variable.kind, attributes)
        for size in variable.shape:
            SubElement(element, "Dimension", start=str(size))
        start = _start(variable, fault)
        if isinstance(start, str):
            SubElement(element, "Start", value=start)
        elif start is not None:
            element.set("start", _in_xml(start))
    structure = SubElement(root, "ModelStructure")
    outputs = [variable for variable in facts.variables if variable.causality == "output"]
    for variable in outputs:
        known = " ".join(str(facts.reference(name)) for name in variable.follows)
        own = str(facts.reference(variable.name))
        SubElement(structure, "Output", valueReference=own, dependencies=known)
    for variable in outputs:
        if not variable.exact:
            own = str(facts.reference(variable.name))
            SubElement(structure, "InitialUnknown", valueReference=own)
    return root
