"""Shared libraries of C sources, for one platform or several.

For this machine the compiler is `CC`, or `cc` where there is one. For others, and without one, it
is ziglang, which brings the C libraries of all platforms: what it links for Linux runs from glibc
2.17 on.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..generated import cache, keep
from .errors import NativeError

FLAGS = (
    "-std=c99",
    "-O3",
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",
    "-fno-sanitize=undefined",
)
LINKED = ("-shared", "-s")
INCLUDE = re.compile(rb'^#include "([^"]+)"', re.MULTILINE)
FAT_MAGIC = 0xCAFEBABE
SLICES = {"x86_64": (0x01000007, 3), "aarch64": (0x0100000C, 0)}
"""CPU type and subtype of Mach-O."""
ALIGNMENT = 14


@dataclass(frozen=True)
class Platform:
    """A folder of `binaries/` in an FMU, and the machines that its library serves.

    `targets` has the machines as zig names them, `folders` as the folders of FMI 3.
    """

    suffix: str
    targets: tuple[str, ...]
    folders: tuple[str, ...]


PLATFORMS = {
    "linux64": Platform(".so", ("x86_64-linux-gnu.2.17",), ("x86_64-linux",)),
    "win64": Platform(".dll", ("x86_64-windows-gnu",), ("x86_64-windows",)),
    "darwin64": Platform(
        ".dylib", ("x86_64-macos", "aarch64-macos"), ("x86_64-darwin", "aarch64-darwin")
    ),
}


def own_platform() -> str:
    """The platform of this machine."""
    names = {"linux": "linux64", "win32": "win64", "darwin": "darwin64"}
    return names.get(sys.platform, sys.platform)


def checked(names: list[str]) -> list[str]:
    """Platforms to build for, this machine's if none is named; `NativeError` on another."""
    wanted = sorted(set(names)) or [own_platform()]
    for name in wanted:
        if name not in PLATFORMS:
            raise NativeError(f"no platform {name!r}; there is {', '.join(PLATFORMS)}")
    return wanted


def compiler(target: str, *, own: bool) -> list[str]:
    """Command of a C compiler for a target; :class:`NativeError` where there is none.

    A Mac's own compiler serves one of its two machines, so that both are left to ziglang.
    """
    given = os.environ.get("CC", "")
    if own and len(PLATFORMS[own_platform()].targets) == 1:
        command = shlex.split(given) or ["cc"]
        if shutil.which(command[0]):
            return command
        if given:
            raise NativeError(f"CC={given!r}: there is no such command; unset CC, or correct it")
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", target]
    way = "install a C compiler (cc), name one in CC, or " if own else ""
    raise NativeError(f"no C compiler for {target}: {way}pip install 'resilin[native]'")


def libraries(
    sources: Sequence[Path], platforms: list[str], identifier: str, into: Path, fmi: int
) -> None:
    """Write `into/PLATFORM/IDENTIFIER.SUFFIX` for each platform, as that version of FMI names it.

    FMI 3 has a folder for each machine, FMI 2 one file for both of a Mac's.
    """
    for name in platforms:
        platform = PLATFORMS[name]
        work = into.with_name("work") / name
        parts = []
        for target in platform.targets:
            folder = work / target
            folder.mkdir(parents=True)
            library = folder / f"{identifier}{platform.suffix}"
            compiled(sources, library, compiler(target, own=name == own_platform()))
            parts.append((target.split("-")[0], library.read_bytes()))
        whole = parts[0][1] if len(parts) == 1 else _universal(parts)
        folders = {name: whole}
        if fmi == 3:
            folders = dict(zip(platform.folders, (code for _, code in parts), strict=True))
        for folder_name, code in folders.items():
            (into / folder_name).mkdir(parents=True)
            (into / folder_name / f"{identifier}{platform.suffix}").write_bytes(code)


def compiled(sources: Sequence[Path], library: Path, command: Sequence[str]) -> None:
    """Compile sources into a shared library, under plain names: a linker may keep them inside.

    What one source compiles to is kept under the user's cache folder, by the digest of its text,
    the files it includes, the compiler and its options: a part's own code is compiled once,
    whatever is built around it.
    """
    folder = library.parent
    objects = [_object(source, folder, command) for source in sources]
    _done([*command, *FLAGS, *LINKED, *objects, "-o", library.name, "-lm"], folder)


def _object(source: Path, into: Path, command: Sequence[str]) -> str:
    """Name of the object file of a source in a folder: from the cache or made now."""
    digest = hashlib.sha256(repr((*command, *FLAGS, _release(tuple(command)))).encode())
    for name, text in _included(source).items():
        digest.update(name.encode() + b"\0" + text + b"\0")
    place = cache() / "objects" / f"{digest.hexdigest()[:32]}.o"
    made = into / f"{source.stem}.o"
    if place.is_file():
        shutil.copyfile(place, made)
        return made.name
    _done([*command, *FLAGS, "-c", source.name, "-o", str(made.absolute())], source.parent)
    keep(place, made.read_bytes())
    return made.name


def _included(source: Path) -> dict[str, bytes]:
    """A source and all files of its folder that it includes, by name."""
    found: dict[str, bytes] = {}
    waiting = [source.name]
    while waiting:
        path = source.parent / waiting.pop()
        if path.name not in found and path.is_file():
            found[path.name] = path.read_bytes()
            waiting += [name.decode() for name in INCLUDE.findall(found[path.name])]
    return dict(sorted(found.items()))


@functools.cache
def _release(command: tuple[str, ...]) -> str:
    """What a compiler says of its version."""
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return done.stdout


def _done(words: Sequence[str], folder: Path) -> None:
    """Run a compiler in a folder; :class:`NativeError` with its first lines where it fails."""
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder)
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        raise NativeError(f"{shlex.join(words)}: compiling failed: {' '.join(lines[:3])}")


def _universal(parts: list[tuple[str, bytes]]) -> bytes:
    """One Mach-O file with a slice for each machine."""
    align = 1 << ALIGNMENT
    place = align
    head = struct.pack(">II", FAT_MAGIC, len(parts))
    body = b""
    for machine, code in parts:
        kind, subtype = SLICES[machine]
        head += struct.pack(">IIIII", kind, subtype, place, len(code), ALIGNMENT)
        padded = code + bytes(-len(code) % align)
        body += padded
        place += len(padded)
    return head + bytes(align - len(head)) + body
