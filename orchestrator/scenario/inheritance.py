"""`extends` and `without`: a scenario laid over another one."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..errors import ScenarioError, nearest, printable
from .files import read_tree, scenario_path
from .metric_expression import expression_of

DEEPEST_EXTENDS = 10
LISTS = ("wires", "variables", "actions", "faults")
"""Lists to which a scenario adds what its base has."""


def _merged(path: Path, seen: list[Path]) -> dict[str, Any]:
    """TOML tree of a scenario on top of what it extends."""
    resolved = path.resolve()
    if resolved in seen or len(seen) > DEEPEST_EXTENDS:
        chain = " -> ".join(p.name for p in [*seen, resolved])
        raise ScenarioError(f"{path}: extends itself: {chain}")
    return _based(read_tree(path), path, [*seen, resolved])


def _based(tree: dict[str, Any], path: Path, seen: list[Path]) -> dict[str, Any]:
    """A tree on top of what it extends; `seen` are the files it came through."""
    if problems := list(_misshapen(tree)):
        raise ScenarioError(f"{path}: {problem}" for problem in problems)
    base_name = tree.pop("extends", None)
    dropped = tree.pop("without", [])
    inherits = tree.get("record", {}).pop("inherit", True)
    if base_name is None:
        for key, given in (("without", dropped), ("record.inherit", not inherits)):
            if given:
                raise ScenarioError(f"{path}: {key}: has a meaning only beside extends")
        return tree
    base_path = scenario_path(base_name, path.parent)
    base = _merged(base_path, seen)
    _anchor(base, base_path, path)
    _drop(base, dropped, path)
    _drop_wired_holds(base, tree.get("wires", []))
    if not inherits:
        base.pop("record", None)
    return _overlaid(base, tree) | {
        "without": [*base.get("without", []), *dropped],
        "of_replaced": [*base.get("of_replaced", []), *_of_replaced(base, tree)],
    }


def _anchor(base: dict[str, Any], base_path: Path, path: Path) -> None:
    """Make files of an extended scenario absolute, so that they are found from any other folder."""
    folder = base_path.resolve().parent
    if folder == path.resolve().parent:
        return
    for component in base.get("components", {}).values():
        if isinstance(component.get("data"), str):
            component["data"] = str(folder / component["data"])
        fmu = component.get("fmu")
        if isinstance(fmu, str) and (fmu.endswith(".fmu") or "/" in fmu):
            component["fmu"] = str(folder / fmu)


SHAPES: dict[str, tuple[type, str]] = {
    "extends": (str, "the name of a scenario"),
    "without": (list, "a list of components"),
    "time": (dict, "a table"),
    "master": (dict, "a table"),
    "components": (dict, "a table of tables"),
    "wires": (list, "a list of tables, written [[wires]]"),
    "hold": (dict, "a table"),
    "record": (dict, "a table"),
    "metrics": (dict, "a table"),
    "plot": (dict, "a table"),
    "actions": (list, "a list of tables, written [[actions]]"),
    "faults": (list, "a list of tables, written [[faults]]"),
}


def _misshapen(tree: dict[str, Any]) -> Iterator[str]:
    """What keeps a tree from being merged with another: values that are not tables or lists."""
    for key, (kind, words) in SHAPES.items():
        if key in tree and not isinstance(tree[key], kind):
            yield f"{key}: expected {words}"
            return
    if "of_replaced" in tree:
        yield "of_replaced: unknown key; it follows from extends"
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
    yield from _misshapen_record(tree.get("record", {}))


def _misshapen_record(record: dict[str, Any]) -> Iterator[str]:
    if not isinstance(record.get("inherit", True), bool):
        yield "record.inherit: expected true or false"
    variables = record.get("variables", [])
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
    """Remove components and everything that names them."""
    components = tree.get("components", {})
    for name in names:
        if name not in components:
            raise ScenarioError(
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
        tree["metrics"] = {
            key: text
            for key, text in tree.get("metrics", {}).items()
            if not _mentions(text, prefix)
        }


def _mentions(text: Any, prefix: str) -> bool:
    """Whether a metric needs a variable of a component; what cannot be read is kept."""
    try:
        return any(name.startswith(prefix) for name in expression_of(text).variables)
    except (ValueError, TypeError, AttributeError):
        return False


def _of_replaced(base: dict[str, Any], top: dict[str, Any]) -> Iterator[str]:
    """Inherited record patterns and metrics of components to which `top` gives another source."""
    old = base.get("components", {})
    replaced = [
        f"{name}."
        for name, component in top.get("components", {}).items()
        if name in old and _is_other(component, old[name])
    ]
    for pattern in base.get("record", {}).get("variables", []):
        if any(pattern.startswith(prefix) for prefix in replaced):
            yield pattern
    for name, text in base.get("metrics", {}).items():
        if name not in top.get("metrics", {}) and any(_mentions(text, p) for p in replaced):
            yield name


def _is_other(component: dict[str, Any], old: dict[str, Any]) -> bool:
    """Whether a component names another `fmu` or `data` than the one that it is laid over."""
    return any(key in component and component[key] != old.get(key) for key in ("fmu", "data"))


def _drop_wired_holds(base: dict[str, Any], wires: Any) -> None:
    """Drop inherited holds of inputs that a new wire feeds, by variable or by port."""
    targets = [w["to"] for w in wires if isinstance(w, dict) and isinstance(w.get("to"), str)]
    base["hold"] = {
        key: value
        for key, value in base.get("hold", {}).items()
        if not any(key == target or key.startswith(f"{target}.") for target in targets)
    }


def _overlaid(base: dict[str, Any], top: dict[str, Any]) -> dict[str, Any]:
    """`top` over `base`: tables merge, wires and recorded variables add up, all else replaces.

    A component that names another `fmu` keeps the start values of its base, marked as inherited;
    one that names other `data` keeps only what `top` gives.
    """
    merged = dict(base)
    for key, value in top.items():
        old = merged.get(key)
        if isinstance(value, dict) and isinstance(old, dict):
            if _is_other(value, old):
                merged[key] = _exchanged(old, value)
            else:
                merged[key] = _overlaid(old, value)
                claim(merged[key], value.get("start", {}))
        elif key in LISTS and isinstance(value, list) and isinstance(old, list):
            merged[key] = [*old, *value]
        else:
            merged[key] = value
    return merged


def claim(component: dict[str, Any], start: dict[str, Any]) -> None:
    """Note that start values are a scenario's own, and no longer inherited from another FMU."""
    if "inherited" in component:
        component["inherited"] = [name for name in component["inherited"] if name not in start]


def _exchanged(old: dict[str, Any], new: dict[str, Any]) -> dict[str, Any]:
    """A component with another source: an FMU keeps the start values that it does not give itself.

    A recording has none.
    """
    if "data" in new:
        return new
    kept, given = old.get("start", {}), new.get("start", {})
    inherited = [name for name in kept if name not in given]
    if not inherited:
        return new
    return {**new, "start": {**kept, **given}, "inherited": inherited}
