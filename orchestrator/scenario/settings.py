"""The settings of a scenario as texts by name, as `amplifier.frequency` or `time.stop`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from ..errors import printable

LONGEST = 120
"""Characters of one setting."""
OF_COMPONENTS = ("inherited",)
OF_SCENARIO = ("components", "wires", "title", "without", "of_replaced", "metrics", "plot")
"""Keys that are no settings, or are read otherwise."""


def given(
    changes: Mapping[str, Any] | None, options: Mapping[str, Mapping[str, Any]]
) -> dict[str, str]:
    """What is set beside a scenario's file: start values, and single keys of its tables."""
    tables = {
        f"{table}.{key}": value
        for table, keys in options.items()
        for key, value in (keys or {}).items()
    }
    return {name: _text(value) for name, value in {**(changes or {}), **tables}.items()}


def settings_of(scenario: Mapping[str, Any]) -> dict[str, str]:
    """All settings of a scenario as a result keeps it; of one that is damaged what can be read."""
    return {
        name: _text(value)
        for name, value in (*_of_components(scenario), *_of_tables(scenario))
        if value is not None
    }


def _of_components(scenario: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, component in _table(scenario, "components").items():
        if not isinstance(component, dict):
            continue
        for key, value in _table(component, "start").items():
            yield f"{name}.{key}", value
        for key, value in component.items():
            if key != "start" and key not in OF_COMPONENTS:
                yield f"components.{name}.{key}", value
    wires = scenario.get("wires")
    for wire in wires if isinstance(wires, list) else []:
        if isinstance(wire, dict):
            ends = f"wire {wire.get('from')} to {wire.get('to')}"
            yield ends, f"gain {wire.get('gain', 1)}, offset {wire.get('offset', 0)}"


def _of_tables(scenario: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in scenario.items():
        if key in OF_SCENARIO:
            continue
        if isinstance(value, dict):
            yield from ((f"{key}.{name}", each) for name, each in value.items())
        elif isinstance(value, list):
            yield from ((f"{key}[{k}]", each) for k, each in enumerate(value))
        else:
            yield key, value


def _table(of: Mapping[str, Any], key: str) -> dict[str, Any]:
    found = of.get(key)
    return found if isinstance(found, dict) else {}


def _text(value: Any) -> str:
    if isinstance(value, dict) and set(value) == {"per_cycle"}:
        return f"{value['per_cycle']} per cycle"
    if isinstance(value, str):
        return printable(value, most=LONGEST)
    return printable(json.dumps(value, ensure_ascii=False, default=str), most=LONGEST)
