"""Parts in folders of one's own: imported beside those of the package, with the same way in."""

from __future__ import annotations

import importlib
import sys
import traceback
from pathlib import Path
from typing import Any

import fmus

from .sources import SOURCES, BuildError

C_FILES = ("dual", "fmi2", "fmi3", "instance", "semantics", "words")


def is_folder(text: str) -> bool:
    """Whether a text names a folder of one's own, and not a part of the package."""
    return any(mark in text for mark in "/\\") or text in {".", ".."}


def forbidden(name: str) -> str:
    """Why a part of one's own cannot have this name; empty where it can."""
    if (SOURCES / name / "slave.py").is_file():
        return "is the name of a part of the package"
    if name in C_FILES:
        return "is the name of a C file that every compiled FMU has"
    if (SOURCES / name).exists() or (SOURCES / f"{name}.py").exists():
        return "is a module of the package"
    return ""


def outside_part(folder: Path) -> Any:
    """The `PART` of a folder with `slave.py` and `physics.py`; `BuildError` where it has none.

    The folder is imported as `fmus.NAME`, so that its relative imports are those of the package's
    own parts; its parent is searched after the package itself.
    """
    place = folder.resolve()
    name = place.name
    if not (place / "slave.py").is_file():
        raise BuildError(f"{folder}: is no part: has no slave.py; resilin new part NAME makes one")
    reason = forbidden(name) if name.isidentifier() else "cannot name a part"
    if reason:
        raise BuildError(f"{folder}: {name!r} {reason}: rename it, also in its slave.py")
    _make_importable(place)
    try:
        module = importlib.import_module(f"fmus.{name}.slave")
    except Exception as error:  # whatever a stranger's module raises
        raise BuildError(_where(place, error)) from None
    part = getattr(module, "PART", None)
    if part is None or getattr(part, "name", None) != name:
        raise BuildError(f"{folder}/slave.py: has no PART of the name {name!r}, that of its folder")
    return part


def _make_importable(place: Path) -> None:
    """Put a folder where `fmus.NAME` is looked for, and forget one of that name elsewhere."""
    package = f"fmus.{place.name}"
    known = sys.modules.get(package)
    if known is not None and Path(str(known.__file__)).parent != place:
        for module in [m for m in sys.modules if m == package or m.startswith(f"{package}.")]:
            del sys.modules[module]
    parent = str(place.parent)
    others = [path for path in fmus.__path__ if path not in {str(SOURCES), parent}]
    fmus.__path__[:] = [str(SOURCES), parent, *others]
    importlib.invalidate_caches()


def _where(place: Path, error: Exception) -> str:
    """What was wrong in the folder's own files, with file and line."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}: {error.msg}"
    frames = [
        f for f in traceback.extract_tb(error.__traceback__) if f.filename.startswith(str(place))
    ]
    spot = f"{frames[-1].filename}:{frames[-1].lineno}" if frames else str(place)
    return f"{spot}: {type(error).__name__}: {error}"
