"""The scenario that a result carries as an attribute, from this release or the one before."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from ..scenario.settings import settings_of

NAMES = ("scenario", "scene")
"""Name of the attribute, and the one that the previous release gave it."""


def scenario_table(attributes: Mapping[Any, Any], key: str) -> dict[str, Any]:
    """A table of the scenario behind a result, as `metrics`; empty where there is none to read."""
    table = _scenario(attributes).get(key)
    return table if isinstance(table, dict) else {}


def settings(attributes: Mapping[Any, Any]) -> dict[str, str]:
    """The settings of the run or sweep behind a result, with the step that it took [s]."""
    found = settings_of(_scenario(attributes))
    with suppress(KeyError, TypeError, ValueError):
        found |= {"time.step": f"{float(attributes['communication_step']):.6g} s"}
    with suppress(TypeError, ValueError, AttributeError):
        digests = json.loads(attributes.get("fmu_sha256", "{}"))
        found |= {f"FMU of {name}": f"SHA-256 {str(d)[:8]}" for name, d in digests.items()}
    return found


def _scenario(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    text = next((attributes[name] for name in NAMES if name in attributes), "{}")
    try:
        found = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}
