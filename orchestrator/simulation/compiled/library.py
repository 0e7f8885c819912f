"""The compiled loop as a shared library: built at first use, kept under the user's cache folder."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
SOURCES = ("instance.c", "master.c", "watch.c", "loop.c", "control.c")
FLAGS = ("-std=c11", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden")
SWITCH = "RESILIN_LOOP"
"""Environment variable: `python` keeps to the Python loop."""


@functools.cache
def library() -> Any | None:
    """The loaded library; None where there is no compiler, or where the user wants none of it."""
    if os.environ.get(SWITCH) == "python" or sys.platform == "win32":
        return None
    path = _cached()
    try:
        if not path.is_file():
            _compile(path)
        return ctypes.CDLL(str(path))
    except (OSError, subprocess.SubprocessError):
        return None


def missing() -> str:
    """Why there is no compiled loop; "" where there is one."""
    if library() is not None:
        return ""
    if os.environ.get(SWITCH) == "python":
        return f"{SWITCH} asks for the Python loop"
    return "no C compiler was found: install cc, or pip install 'resilin[native]'"


def compiler() -> list[str] | None:
    """The command of a C compiler: CC, the system's, or ziglang's; None without one."""
    named = os.environ.get("CC", "").split()
    if named and shutil.which(named[0]):
        return named
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"]
    return None


def _cached() -> Path:
    """Where the library is kept, by the digest of its sources and the kind of machine."""
    digest = hashlib.sha256(repr((FLAGS, platform.machine(), sys.platform)).encode())
    for name in ("loop.h", *SOURCES):
        digest.update((HERE / name).read_bytes())
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "resilin"
    return root / f"loop-{digest.hexdigest()[:16]}.so"


def _compile(path: Path) -> None:
    """Compile beside the place and rename, so that another process never sees half a file."""
    command = compiler()
    if command is None:
        raise FileNotFoundError("no C compiler")
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix="loop-") as folder:
        made = Path(folder) / path.name
        sources = [str(HERE / name) for name in SOURCES]
        subprocess.run(
            [*command, *FLAGS, "-o", str(made), *sources, "-lm"],
            check=True,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=300,
        )
        made.replace(path)
