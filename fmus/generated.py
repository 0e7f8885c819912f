"""Data files that the build makes and ships, as a part reads them.

Inside an FMU such a file stands beside the module that reads it; in the source tree it is made on
first use and kept under the user's cache folder, by the digest of what it is made from.
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


def shipped(path: Path, sources: Sequence[Path], make: Callable[[], str]) -> str:
    """The text of a generated file: as it was shipped, or from the cache, or made now."""
    if path.is_file():
        return path.read_text(encoding="utf-8")
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.read_bytes())
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "resilin"
    kept = root / f"{path.parent.name}-{digest.hexdigest()[:16]}{path.suffix}"
    if kept.is_file():
        return kept.read_text(encoding="utf-8")
    text = make()
    try:
        root.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=root, delete=False, encoding="utf-8") as file:
            file.write(text)
        Path(file.name).replace(kept)
    except OSError:
        pass
    return text
