"""Pydantic's problems in the words of a scenario file."""

from __future__ import annotations

import difflib
import reprlib
from typing import Any

from pydantic import BaseModel

from ..errors import printable
from .schema import (
    ActionSpec,
    Component,
    MasterSettings,
    Metrics,
    PerCycle,
    Record,
    Scenario,
    Time,
    Wire,
)

BRANCHES = {"PerCycle", "float", "str", "constrained-str", "bool"}
"""Names of a union's branches in the place that pydantic gives for a problem."""


def _worded(errors: list[Any]) -> list[str]:
    """Pydantic's problems as `key: what, remedy`, one for each key.

    Where a value may be a number, a text or a table, pydantic reports one problem for each type;
    the one for the value's own type counts.
    """
    messages: dict[str, str] = {}
    for problem in errors:
        place = [str(step) for step in problem["loc"]]
        branch = next((k for k, step in enumerate(place) if step in BRANCHES), len(place))
        parts = place[:branch] + [s for s in place[branch:] if s not in BRANCHES]
        value = problem["input"]
        inside = "PerCycle" in place and problem["type"] != "model_type"
        key = ".".join(place[:branch])
        if inside or problem["type"] == "finite_number" or key not in messages:
            messages[key] = _message(".".join(parts), parts, problem, value, branch < len(place))
    return list(messages.values())


def _message(key: str, parts: list[str], problem: Any, value: Any, union: bool) -> str:
    """One problem as `key: what, remedy`."""
    given = printable(reprlib.repr(value), most=60)
    if problem["type"] == "extra_forbidden":
        return f"{key}: unknown key; {_suggestion(parts, parts[-1])}"
    if problem["type"] == "component":
        return f"{key}.{problem['msg']}"
    if problem["type"] == "missing":
        return f"{key}: is missing"
    if problem["type"] == "finite_number":
        return f"{key}: {given} is not a finite number"
    if parts[0] == "hold" and isinstance(value, dict):
        inside = value
        name = key.removeprefix("hold.")
        while isinstance(inside, dict) and inside:
            word, inside = next(iter(inside.items()))
            name = f"{name}.{word}"
        return f'{key}: quote the whole name, as "{printable(name)}" = ...'
    if union and len(parts) and problem["type"] in {"float_type", "string_type", "model_type"}:
        return f"{key}: expected a number, or a text with a unit, got {given}"
    return f"{key}: {problem['msg']}, got {given}"


def _suggestion(place: list[str], word: str) -> str:
    """Nearest key of the table that holds an unknown one, or all keys of it."""
    tables: dict[str, type[BaseModel]] = {
        "time": Time,
        "master": MasterSettings,
        "record": Record,
        "metrics": Metrics,
        "components": Component,
        "wires": Wire,
        "actions": ActionSpec,
    }
    table = Scenario if len(place) == 1 else tables.get(place[0], Scenario)
    if len(place) == 3 and place[:2] == ["time", "step"]:
        table = PerCycle
    keys = [field.alias or name for name, field in table.model_fields.items()]
    if table is Scenario:
        keys += ["extends"]
        keys.remove("of_replaced")
    close = difflib.get_close_matches(word, keys, n=1)
    return f"did you mean {close[0]!r}?" if close else f"there is {', '.join(sorted(keys))}"
