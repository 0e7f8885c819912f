"""Data files that the build makes and ships, as a part reads them.

Inside an FMU such a file stands beside the module that reads it. In the source tree it is made on
first use; what was made is kept under the user's cache folder, by the digest of what it is made of.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any


def tuples(value: Any) -> Any:
    """Lists within lists, as JSON has them, as tuples within tuples."""
    return tuple(tuples(entry) for entry in value) if isinstance(value, list) else value


def literal(text: str) -> str:
    """A text of a stranger's as Python source has it."""
    plain = text.isascii() and text.isprintable() and not set(text) & {'"', "\\"}
    return f'"{text}"' if plain else repr(text)


def shipped(path: Path, make: Callable[[], str]) -> str:
    """The text of a generated file: as it was shipped, or as it is made."""
    return path.read_text(encoding="utf-8") if path.is_file() else make()


def kept(name: str, sources: Sequence[Path], data: str, make: Callable[[str], str]) -> str:
    """What `make` gives for `data`, made once: it is kept by the digest of `sources` and data."""
    digest = hashlib.sha256(data.encode())
    for source in sources:
        digest.update(source.read_bytes())
    place = cache() / f"{digest.hexdigest()[:16]}-{name}"
    if place.is_file():
        return place.read_text(encoding="utf-8")
    text = make(data)
    keep(place, text.encode())
    return text


def cache() -> Path:
    """The project's part of the user's cache folder."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "resilin"


def keep(place: Path, content: bytes) -> bool:
    """Write a file of the cache, whole or not at all; whether that was possible."""
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("wb", dir=place.parent, delete=False) as file:
            file.write(content)
        Path(file.name).replace(place)
    except OSError:
        return False
    return True
