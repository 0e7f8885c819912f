"""The scenario that a result carries as an attribute, from this release or the one before."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

NAMES = ("scenario", "scene")
"""Name of the attribute, and the one that the previous release gave it."""


def scenario_table(attributes: Mapping[Any, Any], key: str) -> dict[str, Any]:
    """A table of the scenario behind a result, as `metrics`; empty where there is none to read."""
    text = next((attributes[name] for name in NAMES if name in attributes), "{}")
    try:
        table = json.loads(text)[key]
    except (KeyError, ValueError, TypeError):
        return {}
    return table if isinstance(table, dict) else {}
