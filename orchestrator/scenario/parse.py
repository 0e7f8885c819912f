"""A scenario as checked data, from its file or from a tree, with all problems at once."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import ScenarioError, nearest
from .files import read_tree, scenario_path
from .inheritance import _based, claim
from .schema import Scenario
from .validation import _worded


def load_scenario(
    name: str | Path, changes: dict[str, str] | None = None, **options: Any
) -> tuple[Scenario, Path]:
    """Scenario by name or path, with `component.parameter` values changed; and its file.

    `options` override single keys, as `master={"laws": "held"}`. Raises
    :class:`ScenarioError` with every problem found.
    """
    path = scenario_path(str(name))
    return scenario_of(read_tree(path), path, changes, **options), path


def scenario_of(
    tree: dict[str, Any], path: Path, changes: Mapping[str, Any] | None = None, **options: Any
) -> Scenario:
    """The same from a tree; files that it names are found from the folder of `path`."""
    try:
        tree = _based(tree, path, [path.resolve()])
        components = tree.get("components", {})
        for target, text in (changes or {}).items():
            component, _, parameter = target.partition(".")
            if component not in components:
                hint = nearest(component, components)
                raise ScenarioError(f"--set {target}: no component {component!r} in {path}; {hint}")
            components[component].setdefault("start", {})[parameter] = text
            claim(components[component], {parameter: text})
        for key, value in options.items():
            if value:
                tree[key] = {**tree.get(key, {}), **value}
        return Scenario.model_validate(tree)
    except ValidationError as error:
        worded = _worded(error.errors(include_url=False))
        raise ScenarioError(f"{path}: {text}" for text in worded) from None
    except RecursionError:
        raise ScenarioError(f"{path}: nested too deeply") from None
