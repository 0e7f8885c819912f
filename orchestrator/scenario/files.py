"""Where scenarios are found, and how their files are read."""

from __future__ import annotations

import pickle
import re
import tomllib
from functools import cache, lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

from ..errors import ScenarioError, nearest, printable

LARGEST_FILE = 1 << 20
KEPT = 64
"""Texts of scenarios whose trees are kept: those of a study and what they extend."""
SSP = re.compile(r"(.+\.ssp)(?::(.+))?")
"""An SSP archive, and which of its variants or parameter sets."""


def scenario_names() -> list[str]:
    """Names of the scenarios that come with the package."""
    return list(_shipped_names())


@cache
def _shipped_names() -> tuple[str, ...]:
    names = (path.name for path in _shipped().iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def _shipped() -> Any:
    return resources.files("scenarios")


def is_file(path: Path) -> bool:
    """Whether there is a file; there is none at a path that no file system can hold."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def scenario_path(name: str, beside: Path | None = None) -> Path:
    """File of a scenario given by path or by the name of a shipped one.

    A path is taken from the folder of the scenario that names it, else from here. An SSP archive
    may have a choice behind a colon: `system.ssp:cold`.
    """
    if not name:
        raise ScenarioError(f"no scenario ''; {nearest(name, scenario_names())}")
    if (file := SSP.fullmatch(name)) is not None:
        path = Path(file[1]) if beside is None else beside / file[1]
        if not is_file(path):
            raise ScenarioError(f"{path}: no such SSP file")
        return path.with_name(path.name + (f":{file[2]}" if file[2] else ""))
    if name.endswith(".toml") or "/" in name:
        path = Path(name) if beside is None else beside / name
        if _is_folder(path):
            raise ScenarioError(f"{path}: is a folder, not a scenario")
        if not is_file(path):
            raise ScenarioError(f"{path}: no such scenario file")
        return path
    shipped = scenario_names()
    if name in shipped:
        return Path(str(_shipped() / f"{name}.toml"))
    if is_file(Path(name)):
        return Path(name)
    if _is_folder(Path(name)):
        raise ScenarioError(f"{name}: is a folder, not a scenario")
    raise ScenarioError(f"no scenario {printable(name)!r}; {nearest(name, shipped, show=40)}")


def as_base(scenario: str) -> str:
    """How a file in any folder names a scenario that it extends: a name, or the whole path."""
    if scenario in scenario_names():
        return scenario
    return str(scenario_path(scenario).absolute())


def read_tree(path: Path) -> dict[str, Any]:
    """Tree of one scenario, a TOML file or an SSP archive."""
    if (file := SSP.fullmatch(path.name)) is not None:
        from .ssp import read_ssp

        return read_ssp(path.with_name(file[1]), file[2] or "")
    return read_toml(path)


def read_toml(path: Path) -> dict[str, Any]:
    """TOML of one file; `ScenarioError` with the line and a mark where it is not TOML."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise ScenarioError(f"{path}: larger than {LARGEST_FILE >> 20} MiB; not a scenario")
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot be read as UTF-8 text ({error})") from None
    try:
        packed = _packed(text)
        tree: dict[str, Any] = pickle.loads(packed) if packed else tomllib.loads(text)
        return tree
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}: not TOML: {_caret(text, str(error))}") from None
    except (RecursionError, ValueError) as error:
        raise ScenarioError(f"{path}: not TOML that can be read: {type(error).__name__}") from None


@lru_cache(maxsize=KEPT)
def _packed(text: str) -> bytes:
    """The tree of a TOML text, packed: a study reads the same few files for each of its runs.

    Empty where the tree is too deep to be packed.
    """
    try:
        return pickle.dumps(tomllib.loads(text))
    except RecursionError:
        return b""


def _caret(text: str, message: str) -> str:
    """The message, with the place in the line that it names marked."""
    found = re.search(r"line (\d+), column (\d+)", message)
    if found is None:
        return printable(message)
    lines = text.splitlines()
    row, column = int(found[1]) - 1, int(found[2]) - 1
    line = lines[row] if row < len(lines) else ""
    near = line[max(0, column - 30) : column] + ">>>" + line[column : column + 30]
    place = message[found.start() : found.end()]
    return f"{printable(message.partition(' (at')[0])} at {place}: {printable(near)}"
