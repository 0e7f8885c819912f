"""What a part is made of: its files, and the digest that names a build of them."""

from __future__ import annotations

import difflib
import hashlib
import importlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

SOURCES = Path(__file__).resolve().parent.parent


class BuildError(Exception):
    """What keeps an FMU from being built: names the part or parameter, and the way out."""


def nearest(word: str, words: Iterable[str]) -> str:
    """`; did you mean X?`, or the list of what there is."""
    choices = sorted(words)
    close = difflib.get_close_matches(word, choices, n=1)
    return f"did you mean {close[0]!r}?" if close else f"there is {', '.join(choices)}"


def part_names() -> list[str]:
    """Parts that can be built: the folders of `fmus/` that have a slave."""
    return sorted(path.parent.name for path in SOURCES.glob("*/slave.py"))


def load_part(name: str) -> Any:
    """The `PART` of a name in the package, or of a folder, as `./mine`; `BuildError` without."""
    from .outside import is_folder, outside_part

    if is_folder(name):
        return outside_part(Path(name))
    names = part_names()
    if name not in names and (Path(name) / "slave.py").is_file():
        raise BuildError(f"no part {name!r} in the package; for the folder write ./{name}")
    if name not in names:
        raise BuildError(f"no part {name!r}; {nearest(name, names)}")
    return importlib.import_module(f"fmus.{name}.slave").PART


def compilable() -> list[str]:
    """Parts that have a native form: those that need no package when they run."""
    return [name for name in part_names() if not load_part(name).needs]


def source_files(part: Any) -> dict[str, bytes]:
    """Path inside the FMU's package -> text, for all that the part is made of."""
    own = Path(part.physics.__file__).parent
    folders = {"": SOURCES, f"{part.name}/": own}
    folders |= {f"{name}/": SOURCES / name for name in part.includes}
    files: dict[str, bytes] = {}
    for prefix, folder in folders.items():
        for path in sorted(folder.iterdir()):
            test = path.name.startswith("test_")
            if path.suffix in {".py", ".json", ".toml"} and path.is_file() and not test:
                files[f"{prefix}{path.name}"] = path.read_bytes()
    return files


def digest_of(
    name: str, files: dict[str, bytes], starts: dict[str, float], exporter: list[str]
) -> str:
    """SHA-256 over name, sources, changed starts and what tells the exporter."""
    digest = hashlib.sha256()
    head = [name, *exporter, sorted(starts.items())]
    digest.update(json.dumps(head).encode())
    for path, text in sorted(files.items()):
        digest.update(path.encode() + b"\0" + text + b"\0")
    return digest.hexdigest()
