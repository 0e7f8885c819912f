"""Keys of a recorded component as texts from a command's options, not from a scenario's file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import ScenarioError
from .parse import scenario_of
from .schema import Component


def component_of(path: Path, name: str, keys: Mapping[str, str]) -> Component:
    """A component that replays the file, with keys such as `repeat` or `columns.U (kV)`.

    Raises :class:`ScenarioError` with each key that is unknown or has a wrong value.
    """
    tree: dict[str, Any] = {"data": str(path.absolute())}
    for key, text in keys.items():
        table, dot, heading = key.partition(".")
        if dot:
            tree.setdefault(table, {})[heading] = text
        else:
            tree[key] = {"true": True, "false": False}.get(text, text)
    try:
        return scenario_of({"components": {name: tree}}, path).components[name]
    except ScenarioError as error:
        place = f"{path}: components.{name}."
        raise ScenarioError([p.replace(place, "") for p in error.problems]) from None
