"""A staged package: a copy of the sources under a name of its own, exported or compiled."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .sources import BuildError


def stage(
    folder: Path,
    title: str,
    part: Any,
    files: dict[str, bytes],
    starts: dict[str, float],
    digest: str,
    guid: str,
    alike: str,
) -> Path:
    """Write the package and the entry script; return the script.

    The exporter drops one reference too many to the script's namespace, so the script
    pins itself; and it must not define the class, which lives in the package.
    """
    from .. import __version__

    package = f"{title}_{digest[:8]}"
    for path, text in files.items():
        target = folder / package / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text)
    slave = importlib.import_module(f"fmus.{part.name}.slave")
    base = next(key for key, value in vars(slave).items() if getattr(value, "part", None) is part)
    entry = (
        '"""The class behind this FMU."""\n\n'
        f"from .{part.name}.slave import {base}\n\n\n"
        f"class {title}({base}):\n"
        f'    """{part.description}."""\n\n'
        f"    digest = {guid!r}\n"
        f"    sources = {alike!r}\n"
        f"    release = {__version__!r}\n"
        f"    changes = {starts!r}\n"
    )
    (folder / package / "entry.py").write_text(entry, encoding="utf-8")
    script = folder / f"{package}_script.py"
    script.write_text(
        f"from {package}.entry import {title}\n"
        'globals().setdefault("_pins", []).append(globals())\n',
        encoding="utf-8",
    )
    return script


def export(script: Path, into: Path) -> Path:
    """Run the exporter on a staged script.

    An FMU that this process has loaded brings an exporter of its own, without the libraries:
    the one that is installed is put in its place for as long.
    """
    from importlib.metadata import distribution

    with importable(script) as package:
        carried = taken_out("pythonfmu")
        sys.path.insert(0, str(distribution("pythonfmu").locate_file("")))
        try:
            builder = importlib.import_module("pythonfmu").FmuBuilder
            return Path(builder.build_FMU(script, dest=into, project_files={package}))
        finally:
            taken_out("pythonfmu")
            sys.modules.update(carried)


def compiled(
    script: Path,
    title: str,
    part: Any,
    guid: str,
    alike: str,
    starts: dict[str, float],
    platforms: list[str],
    fmi: int,
    *,
    icon: bool,
) -> Path:
    """Compile the physics of a staged package, which has its own tables."""
    from .. import __version__
    from ..native.errors import NativeError
    from ..native.link import checked
    from ..native.package import packed

    into = script.parent / "raw"
    into.mkdir()
    with importable(script) as package:
        own = importlib.import_module(f"{package.name}.{part.name}.slave").PART
        try:
            return packed(
                own, title, guid, alike, __version__, starts, checked(platforms), into, fmi,
                icon=icon,
            )  # fmt: skip
        except NativeError as error:
            raise BuildError(f"{title}: {error}") from None


@contextmanager
def importable(script: Path) -> Iterator[Path]:
    """The staged package beside a script, importable; then what `sys` held before."""
    importlib.invalidate_caches()
    package = script.with_name(script.stem.removesuffix("_script"))
    before = list(sys.path)
    loaded = taken_out(package.name)
    sys.path.insert(0, str(script.parent))
    cached, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield package
    finally:
        sys.path[:] = before
        sys.dont_write_bytecode = cached
        taken_out(package.name)
        sys.modules.update(loaded)


def taken_out(package: str) -> dict[str, Any]:
    """Modules of a package, removed from `sys.modules`: a loaded FMU may have the same ones."""
    names = [name for name in sys.modules if name.split(".")[0].startswith(package)]
    return {name: sys.modules.pop(name) for name in names}
