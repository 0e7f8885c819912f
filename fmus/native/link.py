"""Shared libraries: the object code of a part and the C layer, for one platform or several.

ziglang brings the C libraries of all platforms, so what it links for Linux runs from glibc
2.17 on whatever this machine has. Without it, the system's own `cc` links for this machine.
"""

from __future__ import annotations

import importlib.util
import shutil
import struct
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from .code import Code, emitted
from .errors import NativeError

LAYER = Path(__file__).with_name("layer.c")
FLAGS = (
    "-std=c11",
    "-O2",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",
    "-fno-sanitize=undefined",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-s",
)
FAT_MAGIC = 0xCAFEBABE
SLICES = {"x86_64": (0x01000007, 3), "aarch64": (0x0100000C, 0)}
"""CPU type and subtype of Mach-O."""
ALIGNMENT = 14


@dataclass(frozen=True)
class Slice:
    """One machine of a platform: its names for LLVM and for zig."""

    triple: str
    target: str


@dataclass(frozen=True)
class Platform:
    """A folder of `binaries/` in an FMU, and the machines that its library serves."""

    suffix: str
    slices: tuple[Slice, ...]


PLATFORMS = {
    "linux64": Platform(".so", (Slice("x86_64-unknown-linux-gnu", "x86_64-linux-gnu.2.17"),)),
    "win64": Platform(".dll", (Slice("x86_64-w64-windows-gnu", "x86_64-windows-gnu"),)),
    "darwin64": Platform(
        ".dylib",
        (
            Slice("x86_64-apple-macosx11.0.0", "x86_64-macos"),
            Slice("arm64-apple-macosx11.0.0", "aarch64-macos"),
        ),
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


def libraries(code: Code, table: str, platforms: list[str], identifier: str, into: Path) -> None:
    """Write `into/PLATFORM/IDENTIFIER.SUFFIX` for each platform."""
    for name in platforms:
        platform = PLATFORMS[name]
        work = into.with_name("work") / name
        parts = []
        for slice_ in platform.slices:
            folder = work / slice_.target
            folder.mkdir(parents=True)
            (folder / "table.h").write_text(table, encoding="utf-8")
            (folder / "part.o").write_bytes(emitted(code, slice_.triple))
            target = folder / f"{identifier}{platform.suffix}"
            _link(folder, target, slice_.target, name == own_platform())
            parts.append((slice_.target.split("-")[0], target.read_bytes()))
        (into / name).mkdir(parents=True)
        whole = parts[0][1] if len(parts) == 1 else _universal(parts)
        (into / name / f"{identifier}{platform.suffix}").write_bytes(whole)


def _link(folder: Path, target: Path, zig: str, own: bool) -> None:
    """Compile the layer and link it with the object code; a plain name, since it is kept inside."""
    import fmpy

    headers = Path(fmpy.__file__).parent / "c-code"
    command = [*_compiler(zig, own), *FLAGS, f"-I{headers}", f"-I{folder}"]
    command += [str(LAYER), str(folder / "part.o"), "-o", target.name, "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    if done.returncode != 0:
        told = [line for line in done.stderr.splitlines() if line.strip()]
        raise NativeError(f"{zig}: linking failed: {' '.join(told[:3])}")


def _compiler(zig: str, own: bool) -> list[str]:
    """Command of a C compiler for a target."""
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", zig]
    if own and shutil.which("cc"):
        return ["cc"]
    raise NativeError(f"{zig}: ziglang is not installed; pip install 'resilin[native]'")


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
