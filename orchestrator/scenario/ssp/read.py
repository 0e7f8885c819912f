"""An SSP archive as the tree of a scenario, its FMUs unpacked once for all runs."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import re
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from ...errors import FmuError, Problems, ScenarioError, nearest, printable, renamed
from ...fmi.archive import STRUCTURE, entries, extract, read_entry
from ...fmi.description import Interface, Variable, read_interface
from ...fmi.safe_xml import guarded
from ...units import UnitError, factor
from ..start_values import MOST_NAMED
from .document import Document, Reader, Value
from .flatten import Flat, Joint, flattened
from .flatten import Path as Names
from .names import ANNOTATION, OLD_ANNOTATION, REALS, WHOLE

KEYS = ("time", "master", "record", "metrics", "plot", "actions", "faults")
"""Tables of a scenario that our own annotation carries."""
UNUSED = 30 * 24 * 3600.0
"""Seconds after which an unpacked archive that nothing has read is removed."""
UNFINISHED = 3600.0
"""Seconds after which an unpacking is one of a run that was killed."""
STOP = 1.0
"""End of a run where the archive names none [s], as in other FMI tools."""


def read_ssp(path: Path, chosen: str = "") -> dict[str, Any]:
    """Tree of a scenario as its TOML file would have it.

    `chosen` names a variant (`NAME.ssd` at the top level) or a parameter set (`NAME.ssv` under
    `resources`), which then overrides the parameters bound. Raises :class:`ScenarioError` with
    everything in the file that cannot be taken over.
    """
    try:
        return _tree(path, chosen)
    except FmuError as error:
        raise ScenarioError(str(error)) from None


def _tree(path: Path, chosen: str) -> dict[str, Any]:
    names = entries(path, STRUCTURE)
    description, extra = _choice(path, names, chosen)
    where = f"{path}: {description}"

    def fetch(source: str) -> Any:
        name = _inside(where, source, names)
        return guarded(f"{path}: {name}", read_entry(path, name, STRUCTURE))

    reader = Reader(where, fetch)
    root = guarded(where, read_entry(path, description, STRUCTURE))
    _validate(where, root)
    document = reader.document(root)
    flat = flattened(where, document.system)
    if extra:
        own = Reader(f"{path}: {extra}", fetch)
        _override(flat, list(own.parameters(fetch(extra))), f"{path}: {extra}")
        own.problems.check()
    folder = _unpacked(path)
    files = {p: folder / _inside(where, c.source, names) for p, c in flat.components.items()}
    return _scenario(where, document, flat, files)


def _choice(path: Path, names: list[str], chosen: str) -> tuple[str, str]:
    """The description to read, and a parameter set that is to override it, if any."""
    if not chosen:
        return STRUCTURE, ""
    if f"{chosen}.ssd" in names:
        return f"{chosen}.ssd", ""
    if f"resources/{chosen}.ssv" in names:
        return STRUCTURE, f"resources/{chosen}.ssv"
    known = [Path(n).stem for n in names if re.fullmatch(r"[^/]+\.ssd|resources/[^/]+\.ssv", n)]
    raise ScenarioError(
        f"{path}: no variant or parameter set {printable(chosen)!r}; {nearest(chosen, known)}"
    )


def _inside(where: str, source: str, names: list[str]) -> str:
    """Entry of the archive that an address names; nothing outside the archive is read."""
    parts = urlsplit(source)
    name = unquote(parts.path)
    if parts.scheme or parts.netloc or name not in names:
        hint = nearest(name, names)
        raise ScenarioError(f"{where}: source {printable(source)!r} is not in the archive; {hint}")
    return name


@functools.cache
def _schema() -> Any:
    """The schema of SSP 1.0 that comes with fmpy."""
    import fmpy.ssp
    from lxml import etree

    folder = Path(fmpy.ssp.__file__).parent / "schema"
    return etree.XMLSchema(file=str(folder / "SystemStructureDescription.xsd"))


def _validate(where: str, root: Any) -> None:
    """Check a description of version 1 against its schema; fmpy has no schema of 2.0."""
    if (root.get("version") or "").startswith("1.") and not _schema().validate(root):
        fault = _schema().error_log[0]
        raise ScenarioError(f"{where}: line {fault.line}: {printable(fault.message)}")


def _override(flat: Flat, values: list[Value], where: str) -> None:
    """Put the values of a set in the place of those bound."""
    for value in values:
        if not flat.put((), value):
            known = [".".join(path) for path in flat.components]
            known += [".".join((*path, name)) for path, name in flat.settable]
            raise ScenarioError(
                f"{where}: parameter {printable(value.name)!r} does not belong to a component;"
                f" {nearest(value.name.split('.')[0], known)}"
            )


def _unpacked(path: Path) -> Path:
    """Folder with the archive's content, under the user's cache, made once for each content.

    Making one removes those that nothing has read for `UNUSED`, and what killed runs have left.
    """
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:24]
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "resilin" / "ssp"
    folder = root / digest
    if folder.is_dir():
        with contextlib.suppress(OSError):
            os.utime(folder)
        return folder
    try:
        root.mkdir(parents=True, exist_ok=True)
        waiting = Path(tempfile.mkdtemp(dir=root, prefix=f".{digest}"))
    except OSError as error:
        raise ScenarioError(
            f"{path}: cannot be unpacked into {root} ({error.strerror}); set XDG_CACHE_HOME to a"
            " folder that is writable"
        ) from None
    try:
        extract(path, waiting, STRUCTURE)
        try:
            waiting.rename(folder)
        except OSError:
            if not folder.is_dir():
                raise
    finally:
        shutil.rmtree(waiting, ignore_errors=True)
    _sweep(root, keep=folder)
    return folder


def _sweep(root: Path, keep: Path) -> None:
    """Remove unpacked archives that were last read long ago, and unpackings that never ended."""
    now = time.time()
    for found in root.iterdir():
        with contextlib.suppress(OSError):
            age = now - found.stat().st_mtime
            if found != keep and age > (UNFINISHED if found.name.startswith(".") else UNUSED):
                shutil.rmtree(found, ignore_errors=True)


def _scenario(
    where: str, document: Document, flat: Flat, files: dict[Names, Path]
) -> dict[str, Any]:
    known = {file: read_interface(file) for file in dict.fromkeys(files.values())}
    interfaces = {path: known[file] for path, file in files.items()}
    titles = _identifiers(where, flat)
    problems = Problems(where)
    components: dict[str, Any] = {}
    for path, file in files.items():
        units = flat.components[path].units
        start = _starts(".".join(path), interfaces[path], flat.values[path], units, problems)
        components[titles[path]] = {"fmu": str(file), "start": start}
    wires = [_wire(joint, titles, interfaces, flat, problems) for joint in flat.joints]
    problems.check()
    fed = {wire["to"] for wire in wires}
    hold = {}
    for path, interface in interfaces.items():
        hold.update(_held(titles[path], interface, fed, components[titles[path]]["start"]))
    tree: dict[str, Any] = {
        "title": document.title,
        "components": components,
        "wires": wires,
        "hold": hold,
        "time": {
            "start": document.start,
            "stop": document.stop if document.stop is not None else document.start + STOP,
            "step": min((i.step for i in interfaces.values() if i.step), default="auto"),
        },
    }
    outputs = [f"{titles[path]}.{name}" for path, name in flat.outputs]
    if outputs:
        tree["record"] = {"variables": outputs}
    return tree | _annotated(where, document)


def _annotated(where: str, document: Document) -> dict[str, Any]:
    """Tables of the scenario that our own annotation carries beside SSP."""
    kind = ANNOTATION
    if kind not in document.annotations and OLD_ANNOTATION in document.annotations:
        kind = OLD_ANNOTATION
        renamed(f"{where}: the annotation {OLD_ANNOTATION}", f"{ANNOTATION}; export it again")
    text = document.annotations.get(kind)
    if text is None:
        return {}
    try:
        tables = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ScenarioError(f"{where}: the annotation {kind} is not JSON ({error})") from None
    if not isinstance(tables, dict):
        raise ScenarioError(f"{where}: the annotation {kind} is not a table")
    return {key: tables[key] for key in KEYS if key in tables}


def _identifiers(where: str, flat: Flat) -> dict[Names, str]:
    """A component's name for each path: letters, digits and `_`, all different."""
    made: dict[Names, str] = {}
    for path in flat.components:
        name = re.sub(r"\W", "_", "_".join(path), flags=re.ASCII)
        name = name if name.isidentifier() else f"_{name}"
        if name in made.values():
            raise ScenarioError(f"{where}: two components would both be called {name}; rename one")
        made[path] = name
    return made


def _starts(
    owner: str,
    interface: Interface,
    values: dict[str, Value],
    units: dict[str, str],
    problems: Problems,
) -> dict[str, float | str | bool]:
    """Start values as the FMU takes them: in its units, choices by name.

    One without a unit is in that of its connector, where that declares one.
    """
    settable = {
        v.name: v
        for v in interface.variables.values()
        if v.startable or v.causality == "structuralParameter"
    }
    starts: dict[str, float | str | bool] = {}
    for name, value in values.items():
        where = f"parameter {printable(f'{owner}.{name}')}"
        variable = settable.get(name)
        if variable is None:
            members = {key for key, v in settable.items() if v.causality == "input"}
            hint = nearest(name, settable.keys() - members, later=members, show=MOST_NAMED)
            problems.add(where, f"the FMU has no such parameter to set; {hint}")
            continue
        try:
            starts[name] = _start(variable, value, units.get(name, ""))
        except (UnitError, ValueError) as error:
            problems.add(where, error)
    return starts


def _start(variable: Variable, value: Value, unit: str) -> float | str | bool:
    given = value.value
    if variable.kind == "Enumeration":
        if isinstance(given, float) and int(given) in variable.codes:
            return variable.choices[variable.codes.index(int(given))]
        if given not in variable.choices:
            hint = nearest(str(given), variable.choices)
            raise ValueError(f"{printable(str(given))!r} is not a choice; {hint}")
        return str(given)
    if variable.kind == "Boolean":
        return given if isinstance(given, bool) else given in {1.0, "true", "1"}
    if not variable.numeric:
        return str(given)
    if isinstance(given, bool) or value.kind not in (*REALS, *WHOLE):
        raise ValueError(f"is a {value.kind}, the FMU takes a {variable.kind}")
    connector = unit or variable.unit
    scale = factor(value.unit, connector) if value.unit and connector else 1.0
    return float(given) * scale * _into_fmu(variable, unit)


def _into_fmu(variable: Variable, unit: str) -> float:
    """Factor from the unit of a variable's connector to the FMU's own.

    1 where either has none: the connector's unit is then that of the variable.
    """
    if not (unit and variable.unit and variable.unit_defined):
        return 1.0
    return factor(unit, variable.unit)


def _wire(
    joint: Joint,
    titles: dict[Names, str],
    interfaces: dict[Names, Interface],
    flat: Flat,
    problems: Problems,
) -> dict[str, Any]:
    ends = []
    for (path, name), causality in ((joint.source, "output"), (joint.target, "input")):
        if path not in titles:
            problems.add(
                "connection", f"ends at {printable('.'.join(path))}, which is not an element"
            )
            return {"from": "", "to": ""}
        variable = interfaces[path].variables.get(name)
        if variable is None or variable.causality != causality:
            known = [v.name for v in interfaces[path].of(causality)]
            problems.add(
                printable(".".join([*path, name])),
                f"is not an {causality} of its FMU; {nearest(name, known)}",
            )
            return {"from": "", "to": ""}
        ends.append((f"{titles[path]}.{name}", variable))
    (source, output), (target, input_) = ends
    declared = [flat.components[p].units.get(n, "") for p, n in (joint.source, joint.target)]
    if any(unit and unit != v.unit for unit, v in zip(declared, (output, input_), strict=True)):
        try:
            scaled = _declared(joint, output, input_, declared)
        except UnitError as error:
            problems.add(f"{printable(source)} -> {printable(target)}", error)
            scaled = {}
        return {"from": source, "to": target, **scaled}
    gain = joint.gain
    defined = output.unit_defined and input_.unit_defined
    if not joint.converts and defined and output.unit and input_.unit:
        try:
            gain /= factor(output.unit, input_.unit)
        except UnitError:
            problems.add(
                f"{printable(source)} [{output.unit}] -> {printable(target)} [{input_.unit}]",
                "units of another kind cannot be connected, converted or not",
            )
    scaled = {} if joint.converts and gain == 1.0 else {"gain": gain}
    return {"from": source, "to": target, **scaled, "offset": joint.offset}


def _declared(
    joint: Joint, output: Variable, target: Variable, units: list[str]
) -> dict[str, float]:
    """Gain and offset of a wire whose connectors declare units of their own.

    From the FMU's unit into the connector's, over the connection, into the unit of the other FMU;
    less the factor by which a wire converts between the two FMUs.
    """
    leaving, arriving = units[0] or output.unit, units[1] or target.unit
    between = factor(leaving, arriving) if joint.converts and leaving and arriving else 1.0
    into = _into_fmu(target, units[1])
    known = output.unit and output.unit_defined and target.unit and target.unit_defined
    wire = factor(output.unit, target.unit) if known else 1.0
    gain = into * joint.gain * between / (_into_fmu(output, units[0]) * wire)
    return {"gain": gain, "offset": into * joint.offset}


def _held(
    title: str, interface: Interface, fed: set[str], starts: dict[str, Any]
) -> dict[str, float | str | bool]:
    """Inputs that nothing feeds, held at their start values, as SSP defines it.

    Of a port its first member, and those that the archive gives a value.
    """
    held: dict[str, float | str | bool] = {}
    for variable in interface.of("input"):
        first = interface.port(variable.port, "input")[0] if variable.port else variable
        if not variable.numeric or fed & {f"{title}.{v.name}" for v in (variable, first)}:
            continue
        if variable is not first and variable.name not in starts:
            continue
        value = starts.get(variable.name, variable.start)
        if variable.kind == "Enumeration" and isinstance(value, float):
            value = variable.choices[variable.codes.index(int(value))]
        kept = bool(value) if variable.kind == "Boolean" else value or 0.0
        held[f"{title}.{variable.name}"] = kept
    return held
