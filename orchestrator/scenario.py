"""A scene: the TOML text as checked data, nothing loaded yet.

`extends` takes another scene as it is and changes what differs; `without` drops components
with all their wires, holds and records. All problems of a file come at once, each with
its key and the nearest right name.
"""

from __future__ import annotations

import difflib
import re
import reprlib
import tomllib
from collections.abc import Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from .errors import SceneError, nearest, printable

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Quantity = Number | Annotated[str, Field(strict=True, min_length=1, max_length=200)]
Text = Annotated[str, Field(strict=True, max_length=2000)]
Flag = Annotated[bool, Field(strict=True)]
LARGEST_FILE = 1 << 20
AUTO = "auto"
DEEPEST_EXTENDS = 10
SSP = re.compile(r"(.+\.ssp)(?::(.+))?")
"""An SSP archive, and which of its variants or parameter sets."""
LISTS = ("wires", "variables", "actions", "faults")
"""Lists to which a scene adds what its base has."""


class _Table(BaseModel):
    """A TOML table: unknown keys are errors, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class PerCycle(_Table):
    """A communication step as a fraction of the drive's cycle."""

    per_cycle: Annotated[int, Field(strict=True, ge=1, le=10_000_000)]


class Time(_Table):
    """Time span and communication step; `frequency` defines the cycle where it is needed.

    With `step = "auto"` a trial run finds the coarsest step that is stable and accurate.
    """

    start: Quantity = 0.0
    stop: Quantity = "50 cycles"
    step: PerCycle | Quantity = PerCycle(per_cycle=200)
    frequency: Quantity | None = None
    tolerance: Annotated[float, Field(strict=True, gt=0.0, lt=1.0)] | None = None


Outside = Literal["hold", "zero", "stop"]


class Component(_Table):
    """One unit: a built part by name or any FMU by path, and its start values; or a recording.

    `isolate` puts it into a process of its own or keeps it from that; there `patience` is
    the time that one call may take, and `memory` what it may allocate. A recording is the file
    `data` with what docs/recordings.md says of it; `memory` is how large it may be.
    """

    fmu: Text | None = None
    start: dict[str, Quantity | Flag] = {}
    isolate: Flag | None = None
    patience: Quantity | None = None
    memory: Quantity | None = None
    data: Text | None = None
    component: Text | None = None
    columns: dict[str, Text] = {}
    units: dict[str, Text] = {}
    interpolation: Literal["held", "linear", "cubic", "band-limited"] = "cubic"
    repeat: Flag | Quantity = False
    offset: Quantity = 0.0
    before: Outside = "hold"
    after: Outside = "stop"
    gaps: Literal["refuse", "bridge"] = "refuse"

    @model_validator(mode="after")
    def _one_source(self) -> Component:
        """Either an FMU or a recording, and keys that mean something to it."""
        fields = type(self).model_fields
        given = {key for key in fields if getattr(self, key) != fields[key].default}
        if (self.fmu is None) == (self.data is None):
            fault = "fmu: is missing" if self.fmu is None else "data: an fmu is named too; keep one"
            raise PydanticCustomError("component", "{fault}", {"fault": fault})
        if self.data is None:
            foreign = given & RECORDED
            fault = ": means nothing without data, the file of a recording"
        else:
            foreign = given & {"start", "isolate", "patience"}
            fault = ": means nothing to a recording, which has no parameters and runs in no process"
        if self.repeat is not False and not foreign:
            foreign = given & {"before", "after"}
            fault = ": means nothing beside repeat, which goes on in both directions"
        if foreign:
            raise PydanticCustomError("component", "{fault}", {"fault": min(foreign) + fault})
        return self


RECORDED = {
    *("component", "columns", "units", "interpolation", "repeat"),
    *("offset", "before", "after", "gaps"),
}
"""Keys of a component that only a recording has."""


class Action(_Table):
    """Values given at a time: tunable parameters, or inputs that are held."""

    at: Quantity
    set: dict[str, Quantity | Flag]


class Fault(_Table):
    """Something injected into a unit, `on` one of its outputs or on all of it.

    From `at` on, `until` it ends if ever; `size` is that of a bias, or the standard deviation
    of noise, which `seed` determines.
    """

    at: Quantity
    on: Text
    kind: Literal["drop", "freeze", "nan", "bias", "noise"]
    until: Quantity | None = None
    size: Quantity | None = None
    seed: Annotated[int, Field(strict=True, ge=0, lt=1 << 63)] = 0


class Wire(_Table):
    """A connection between ports or single variables; `gain` and `offset` for variables."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)
    source: Annotated[Text, Field(alias="from")]
    target: Annotated[Text, Field(alias="to")]
    gain: Number = 1.0
    offset: Number = 0.0


class Master(_Table):
    """The method that steps the units; `laws` says how much of each port is connected.

    The `kind` follows from the wires where it is "auto": see :func:`orchestrator.plan.usual`.

    The rest is for some methods only: `degree` of the polynomial that carries plain numbers
    over a step, `acceleration` of iterations with its `relaxation`, when they count as
    `settled` (relative) and how many `passes` they get.
    """

    kind: Text = "auto"
    laws: Literal["held", "affine", "curvature"] = "curvature"
    order: list[Text] = []
    degree: Annotated[int, Field(strict=True, ge=1, le=3)] = 1
    acceleration: Literal["none", "relaxed", "aitken", "anderson"] = "none"
    relaxation: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = 0.5
    settled: Annotated[float, Field(strict=True, gt=0.0, lt=0.1)] = 1e-9
    passes: Annotated[int, Field(strict=True, ge=2, le=1000)] = 30


class Record(_Table):
    """Which outputs are kept, by pattern, every how many steps, and over what last stretch."""

    variables: list[Text] = ["*"]
    every: Annotated[int, Field(strict=True, ge=1)] = 1
    last: Quantity | None = None


class Metrics(_Table):
    """Over how many of the last cycles the figures of the table are taken."""

    cycles: Annotated[int, Field(strict=True, ge=1)] = 5


class Scenario(_Table):
    """A whole scene, `extends` resolved; `without` tells what has been left out on the way."""

    title: Text = ""
    without: list[Text] = []
    time: Time = Time()
    master: Master = Master()
    components: dict[str, Component] = {}
    wires: list[Wire] = []
    hold: dict[str, Quantity | Flag] = {}
    actions: list[Action] = []
    faults: list[Fault] = []
    record: Record = Record()
    metrics: Metrics = Metrics()


def json_schema() -> dict[str, Any]:
    """JSON Schema of a scene file, `extends` and `without` included.

    A component's `fmu` or `data` may come from the scene that is extended.
    """
    schema = Scenario.model_json_schema(by_alias=True)
    schema["title"] = "Resilin scene"
    schema["properties"] = {
        "extends": {"type": "string", "description": "Scene that this one changes."},
        "without": {
            "type": "array",
            "items": {"type": "string"},
            "description": "Components left out, with their wires, holds and records.",
        },
        **schema["properties"],
    }
    return schema


def scene_names() -> list[str]:
    """Names of the scenes that come with the package."""
    return sorted(
        path.name.removesuffix(".toml")
        for path in _shipped().iterdir()
        if path.name.endswith(".toml")
    )


def _shipped() -> Any:
    return resources.files("scenarios")


def is_file(path: Path) -> bool:
    """Whether there is a file; a path that no file system could hold is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def scene_path(name: str, beside: Path | None = None) -> Path:
    """File of a scene given by path or by the name of a shipped one.

    A path is taken from the folder of the scene that names it, else from here. An SSP archive may
    have a choice behind a colon: `system.ssp:cold`.
    """
    if not name:
        raise SceneError(f"no scene ''; {nearest(name, scene_names())}")
    if (file := SSP.fullmatch(name)) is not None:
        path = Path(file[1]) if beside is None else beside / file[1]
        if not is_file(path):
            raise SceneError(f"{path}: no such SSP file")
        return path.with_name(path.name + (f":{file[2]}" if file[2] else ""))
    if name.endswith(".toml") or "/" in name:
        path = Path(name) if beside is None else beside / name
        if _is_folder(path):
            raise SceneError(f"{path}: is a folder, not a scene")
        if not is_file(path):
            raise SceneError(f"{path}: no such scene file")
        return path
    shipped = scene_names()
    if name in shipped:
        return Path(str(_shipped() / f"{name}.toml"))
    if is_file(Path(name)):
        return Path(name)
    if _is_folder(Path(name)):
        raise SceneError(f"{name}: is a folder, not a scene")
    raise SceneError(f"no scene {printable(name)!r}; {nearest(name, shipped, show=40)}")


def load_scenario(
    name: str | Path, changes: dict[str, str] | None = None, **options: Any
) -> tuple[Scenario, Path]:
    """Scene by name or path, with `component.parameter` values changed; and its file.

    `options` override single keys, as `master={"laws": "held"}`. Raises
    :class:`SceneError` with every problem found.
    """
    path = scene_path(str(name))
    return scenario_of(read_tree(path), path, changes, **options), path


def scenario_of(
    tree: dict[str, Any], path: Path, changes: Mapping[str, Any] | None = None, **options: Any
) -> Scenario:
    """The same from a tree that stands in a file at `path`, from which others are found."""
    try:
        tree = _based(tree, path, [path.resolve()])
        components = tree.get("components", {})
        for target, text in (changes or {}).items():
            component, _, parameter = target.partition(".")
            if component not in components:
                hint = nearest(component, components)
                raise SceneError(f"--set {target}: no component {component!r} in {path}; {hint}")
            components[component].setdefault("start", {})[parameter] = text
        for key, value in options.items():
            if value:
                tree[key] = {**tree.get(key, {}), **value}
        return Scenario.model_validate(tree)
    except ValidationError as error:
        worded = _worded(error.errors(include_url=False))
        raise SceneError(f"{path}: {text}" for text in worded) from None
    except RecursionError:
        raise SceneError(f"{path}: nested too deeply") from None


def _merged(path: Path, seen: list[Path]) -> dict[str, Any]:
    """TOML tree of a scene on top of what it extends."""
    resolved = path.resolve()
    if resolved in seen or len(seen) > DEEPEST_EXTENDS:
        chain = " -> ".join(p.name for p in [*seen, resolved])
        raise SceneError(f"{path}: extends itself: {chain}")
    return _based(read_tree(path), path, [*seen, resolved])


def _based(tree: dict[str, Any], path: Path, seen: list[Path]) -> dict[str, Any]:
    """A tree on top of what it extends; `seen` are the files it came through."""
    if problems := list(_misshapen(tree)):
        raise SceneError(f"{path}: {problem}" for problem in problems)
    base_name = tree.pop("extends", None)
    dropped = tree.pop("without", [])
    if base_name is None:
        if dropped:
            raise SceneError(f"{path}: without: has a meaning only beside extends")
        return tree
    base_path = scene_path(base_name, path.parent)
    base = _merged(base_path, seen)
    _anchor(base, base_path, path)
    _drop(base, dropped, path)
    _release(base, tree.get("wires", []))
    return _overlaid(base, tree) | {"without": [*base.get("without", []), *dropped]}


def _anchor(base: dict[str, Any], base_path: Path, path: Path) -> None:
    """Files of an extended scene stay beside it, wherever the scene that extends it is."""
    folder = base_path.resolve().parent
    if folder == path.resolve().parent:
        return
    for component in base.get("components", {}).values():
        if isinstance(component.get("data"), str):
            component["data"] = str(folder / component["data"])
        fmu = component.get("fmu")
        if isinstance(fmu, str) and (fmu.endswith(".fmu") or "/" in fmu):
            component["fmu"] = str(folder / fmu)


def read_tree(path: Path) -> dict[str, Any]:
    """Tree of one scene, a TOML file or an SSP archive."""
    if (file := SSP.fullmatch(path.name)) is not None:
        from .ssp import read_ssp

        return read_ssp(path.with_name(file[1]), file[2] or "")
    return read_toml(path)


def read_toml(path: Path) -> dict[str, Any]:
    """TOML of one file, with line and caret where it is not TOML."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise SceneError(f"{path}: larger than {LARGEST_FILE >> 20} MiB; not a scene")
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: cannot be read as UTF-8 text ({error})") from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{path}: not TOML: {_caret(text, str(error))}") from None
    except (RecursionError, ValueError) as error:
        raise SceneError(f"{path}: not TOML that can be read: {type(error).__name__}") from None


def _caret(text: str, message: str) -> str:
    """The message, with the place in the line that it names marked."""
    found = re.search(r"line (\d+), column (\d+)", message)
    if found is None:
        return printable(message)
    lines = text.splitlines()
    row, column = int(found[1]) - 1, int(found[2]) - 1
    line = lines[row] if row < len(lines) else ""
    near = line[max(0, column - 30) : column] + ">>>" + line[column : column + 30]
    place = message[found.start() : found.end()]
    return f"{printable(message.partition(' (at')[0])} at {place}: {printable(near)}"


BRANCHES = {"PerCycle", "float", "str", "constrained-str", "bool"}
"""Names that pydantic gives the branches of a union in the place of a problem."""

SHAPES: dict[str, tuple[type, str]] = {
    "extends": (str, "the name of a scene"),
    "without": (list, "a list of components"),
    "time": (dict, "a table"),
    "master": (dict, "a table"),
    "components": (dict, "a table of tables"),
    "wires": (list, "a list of tables, written [[wires]]"),
    "hold": (dict, "a table"),
    "record": (dict, "a table"),
    "metrics": (dict, "a table"),
    "actions": (list, "a list of tables, written [[actions]]"),
    "faults": (list, "a list of tables, written [[faults]]"),
}


def _misshapen(tree: dict[str, Any]) -> Iterator[str]:
    """What would keep a tree from being merged with another: tables that are none."""
    for key, (kind, words) in SHAPES.items():
        if key in tree and not isinstance(tree[key], kind):
            yield f"{key}: expected {words}"
            return
    for name in tree.get("without", []):
        if not isinstance(name, str):
            yield "without: expected a list of components"
    for name, component in tree.get("components", {}).items():
        if not isinstance(component, dict) or not isinstance(component.get("start", {}), dict):
            yield f"components.{name}: expected a table, and a table in start"
    yield from _misshapen_wires(tree.get("wires", []))
    for index, action in enumerate(tree.get("actions", [])):
        if not isinstance(action, dict) or not isinstance(action.get("set"), dict):
            yield f"actions.{index}: expected a table with at and a table set"
    for index, fault in enumerate(tree.get("faults", [])):
        if not isinstance(fault, dict) or not isinstance(fault.get("on"), str):
            yield f"faults.{index}: expected a table with at, on and kind"
    variables = tree.get("record", {}).get("variables", [])
    if not isinstance(variables, list):
        yield "record.variables: expected a list of texts"
        return
    for index, variable in enumerate(variables):
        if not isinstance(variable, str):
            given = printable(reprlib.repr(variable), most=60)
            yield f"record.variables.{index}: expected a text, got {given}"


def _misshapen_wires(wires: list[Any]) -> Iterator[str]:
    for index, wire in enumerate(wires):
        if not isinstance(wire, dict):
            yield f"wires.{index}: expected a table with from and to"
            continue
        for end in ("from", "to"):
            if not isinstance(wire.get(end), str):
                fault = "expected a text" if end in wire else "is missing"
                yield f"wires.{index}.{end}: {fault}"


def _drop(tree: dict[str, Any], names: Any, path: Path) -> None:
    """Remove components and whatever touches them."""
    components = tree.get("components", {})
    for name in names:
        if name not in components:
            raise SceneError(
                f"{path}: without: no component {name!r}; {nearest(str(name), components)}"
            )
        del components[name]
        prefix = f"{name}."
        tree["wires"] = [
            wire
            for wire in tree.get("wires", [])
            if not (wire["from"].startswith(prefix) or wire["to"].startswith(prefix))
        ]
        tree["hold"] = {k: v for k, v in tree.get("hold", {}).items() if not k.startswith(prefix)}
        tree["actions"] = [
            {**a, "set": {k: v for k, v in a["set"].items() if not k.startswith(prefix)}}
            for a in tree.get("actions", [])
        ]
        tree["faults"] = [f for f in tree.get("faults", []) if f["on"].partition(".")[0] != name]
        record = tree.get("record", {})
        if "variables" in record:
            record["variables"] = [v for v in record["variables"] if not v.startswith(prefix)]


def _release(base: dict[str, Any], wires: Any) -> None:
    """Let go of inherited holds that a new wire feeds, by variable or by port."""
    targets = [w["to"] for w in wires if isinstance(w, dict) and isinstance(w.get("to"), str)]
    base["hold"] = {
        key: value
        for key, value in base.get("hold", {}).items()
        if not any(key == target or key.startswith(f"{target}.") for target in targets)
    }


def _overlaid(base: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    """`top` over `base`: tables merge, wires and recorded variables add up, all else replaces.

    A component that names another `fmu` or `data` keeps only what `top` gives.
    """
    merged = dict(base)
    for key, value in top.items():
        old = merged.get(key)
        if isinstance(value, dict) and isinstance(old, dict):
            other = any(k in value and value[k] != old.get(k) for k in ("fmu", "data"))
            merged[key] = value if other else _overlaid(old, value)
        elif key in LISTS and isinstance(value, list) and isinstance(old, list):
            merged[key] = [*old, *value]
        else:
            merged[key] = value
    return merged


def _worded(errors: list[Any]) -> list[str]:
    """Pydantic's problems as `key: what, remedy`, one a key.

    Where a value may be a number, a text or a table, pydantic complains once for each; what
    counts is the branch that the value is of.
    """
    told: dict[str, str] = {}
    for problem in errors:
        place = [str(step) for step in problem["loc"]]
        branch = next((k for k, step in enumerate(place) if step in BRANCHES), len(place))
        parts = place[:branch] + [s for s in place[branch:] if s not in BRANCHES]
        value = problem["input"]
        inside = "PerCycle" in place and problem["type"] != "model_type"
        key = ".".join(place[:branch])
        if inside or problem["type"] == "finite_number" or key not in told:
            told[key] = _told(".".join(parts), parts, problem, value, branch < len(place))
    return list(told.values())


def _told(key: str, parts: list[str], problem: Any, value: Any, union: bool) -> str:
    """The words for one problem."""
    given = printable(reprlib.repr(value), most=60)
    if problem["type"] == "extra_forbidden":
        return f"{key}: unknown key; {_suggestion(parts, parts[-1])}"
    if problem["type"] == "component":
        return f"{key}.{problem['msg']}"
    if problem["type"] == "missing":
        return f"{key}: is missing"
    if problem["type"] == "finite_number":
        return f"{key}: {given} is not a finite number"
    if union and len(parts) and problem["type"] in {"float_type", "string_type", "model_type"}:
        return f"{key}: expected a number, or a text with a unit, got {given}"
    return f"{key}: {problem['msg']}, got {given}"


def _suggestion(place: list[str], word: str) -> str:
    """Nearest key of the table in which an unknown one stands."""
    tables: dict[str, type[BaseModel]] = {
        "time": Time,
        "master": Master,
        "record": Record,
        "metrics": Metrics,
        "components": Component,
        "wires": Wire,
        "actions": Action,
    }
    table = Scenario if len(place) == 1 else tables.get(place[0], Scenario)
    if len(place) == 3 and place[:2] == ["time", "step"]:
        table = PerCycle
    keys = [field.alias or name for name, field in table.model_fields.items()]
    if table is Scenario:
        keys += ["extends", "without"]
    close = difflib.get_close_matches(word, keys, n=1)
    return f"did you mean {close[0]!r}?" if close else f"there is {', '.join(sorted(keys))}"
