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
            number = _number(text) if table in {"gains", "shifts"} else None
            tree.setdefault(table, {})[heading] = text if number is None else number
        elif key in {"skip", "headings", "units_row"} and text.isdecimal():
            tree[key] = int(text)
        elif key == "names":
            tree[key] = [name.strip() for name in text.split(",")]
        else:
            tree[key] = {"true": True, "false": False}.get(text, text)
    try:
        return scenario_of({"components": {name: tree}}, path).components[name]
    except ScenarioError as error:
        place = f"{path}: components.{name}."
        raise ScenarioError([p.replace(place, "") for p in error.problems]) from None


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
