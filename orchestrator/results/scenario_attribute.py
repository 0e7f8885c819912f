"""The scenario that a result carries as an attribute, from this release or the one before."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

NAMES = ("scenario", "scene")
"""Name of the attribute, and the one that the previous release gave it."""


def scenario_table(data: xarray.Dataset, key: str) -> dict[str, Any]:
    """A table of the scenario behind a result, as `metrics`; empty where there is none to read."""
    text = next((data.attrs[name] for name in NAMES if name in data.attrs), "{}")
    try:
        table = json.loads(text)[key]
    except (KeyError, ValueError, TypeError):
        return {}
    return table if isinstance(table, dict) else {}
