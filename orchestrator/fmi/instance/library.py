"""The shared library of an FMU: where it is, how it is loaded and how it is freed."""

from __future__ import annotations

import atexit
import ctypes
import hashlib
import os
from pathlib import Path
from typing import Any

from ...errors import FmuError, printable
from ..archive import platforms
from ..description import Interface


def shared_library(interface: Interface, folder: Path) -> Path:
    """Shared library of this platform; `FmuError` lists the platforms of the FMU.

    It is named after the model identifier; a single library of another name is taken too.
    """
    from fmpy import platform, platform_tuple, sharedLibraryExtension

    place = str(platform_tuple if interface.version == 3 else platform)
    suffix = str(sharedLibraryExtension)
    where = folder / "binaries" / place
    named = where / f"{interface.identifier}{suffix}"
    if named.is_file():
        return named
    others = sorted(where.glob(f"*{suffix}")) if where.is_dir() else []
    if len(others) == 1:
        return others[0]
    if others:
        listed = ", ".join(other.name for other in others)
        raise FmuError(
            f"{interface.path}: no library {named.name} for {place}, but {listed};"
            " name the right one after the model identifier"
        )
    found = ", ".join(platforms(interface.path)) or "none"
    raise FmuError(
        f"{interface.path}: no binary for {place} (available: {found});"
        " rebuild the FMU for this platform"
    )


_ours: dict[tuple[str, bytes], Any] = {}
_ending: set[int] = set()


def loaded(interface: Interface, path: Path) -> Any:
    """The library at a path, in this process.

    A library of this project is loaded once, however many runs unpack it: nothing unloads it, and
    thousands of copies, as a fit makes them, would use up the memory maps of the process. A foreign
    library may keep values from one instance to the next, so each run has a fresh copy.
    """
    if not interface.ours:
        return _loaded(interface, path)
    key = (path.name, hashlib.sha256(path.read_bytes()).digest())
    if key not in _ours:
        _ours[key] = _loaded(interface, path)
    return _ours[key]


def _loaded(interface: Interface, path: Path) -> Any:
    cwd = Path.cwd()
    try:
        os.chdir(path.parent)
        library = ctypes.CDLL(str(path))
    except OSError as error:
        message = printable(str(error), most=400)
        raise FmuError(f"{interface.path}: cannot be loaded: {message}") from None
    finally:
        os.chdir(cwd)
    _end_in_order(library)
    return library


def _end_in_order(library: Any) -> None:
    """Have PythonFMU's interpreter state freed before libraries are unloaded.

    Its library frees that state twice when the process unloads it, which corrupts the heap
    and may abort a process that has done its work; once freed, the state is null by then.
    """
    finish = getattr(library, "finalizePythonInterpreter", None)
    if finish is not None and library._handle not in _ending:
        _ending.add(library._handle)
        atexit.register(finish)
