"""Named entries of a TOML file as checked data: the fits of a calibration, the cases of a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from ..errors import ScenarioError, nearest, renamed
from ..recording.settings import Text
from ..scenario.files import read_toml

RENAMED = {"scene": "scenario", "scenes": "scenarios"}


class Named(BaseModel):
    """A table with a name; unknown keys are errors, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    name: Text


Entry = TypeVar("Entry", bound=Named)


def load_list(
    path: Path, key: str, kind: type[Entry], names: Sequence[str] | None = None
) -> list[Entry]:
    """Entries under `[[key]]` of a file: all of them, or those that are named.

    Raises `ScenarioError` with everything that does not fit, two entries of one name included.
    """
    tree = _with_new_keys(read_toml(path), path)
    unknown = [k for k in tree if k != key]
    if unknown or key not in tree:
        raise ScenarioError(f"{path}: expected [[{key}]] and nothing else, got {sorted(tree)}")
    try:
        adapter: TypeAdapter[list[Entry]] = TypeAdapter(list[kind])  # type: ignore[valid-type]
        entries = adapter.validate_python(tree[key])
    except ValidationError as error:
        raise ScenarioError(
            f"{path}: {'.'.join(map(str, (key, *e['loc'])))}: {e['msg']}"
            for e in error.errors(include_url=False)
        ) from None
    known = [entry.name for entry in entries]
    if not known:
        raise ScenarioError(f"{path}: {key}: is empty")
    if twice := sorted({name for name in known if known.count(name) > 1}):
        raise ScenarioError(f"{path}: {key}: more than one is called {', '.join(twice)}")
    for name in names or ():
        if name not in known:
            raise ScenarioError(f"{path}: {key}: no {name!r}; {nearest(name, known)}")
    return [entry for entry, name in zip(entries, known, strict=True) if not names or name in names]


def _with_new_keys(tree: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """The tree with keys of earlier releases under their names of today."""
    made: dict[str, Any] = {}
    for key, value in tree.items():
        if key in RENAMED:
            renamed(f"{path}: the key {key}", RENAMED[key])
        if isinstance(value, list):
            value = [
                _with_new_keys(each, path) if isinstance(each, Mapping) else each for each in value
            ]
        made[RENAMED.get(key, key)] = value
    return made
