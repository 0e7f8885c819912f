"""Libraries for machines that are not here: linked, and of the right kind."""

from __future__ import annotations

import struct
import zipfile
from pathlib import Path

import pytest

import build_fmus
from fmus.native import link

KINDS = {"linux64": b"\x7fELF\x02\x01", "win64": b"MZ", "darwin64": b"\xca\xfe\xba\xbe"}
MACHINES = {kind for kind, _ in link.SLICES.values()}


def built(folder: Path, *platforms: str) -> dict[str, bytes]:
    """Libraries of the payload for platforms, by platform."""
    fmu = build_fmus.build("payload", native=True, platforms=platforms, into=folder)
    with zipfile.ZipFile(fmu.path) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
        found = {name.split("/")[1]: archive.read(name) for name in names}
    assert set(found) == set(platforms)
    for platform, library in found.items():
        assert library.startswith(KINDS[platform])
        assert b"fmi2DoStep" in library
        assert b"resilin_build" not in library
    return found


def test_two_machines_in_one_library(tmp_path: Path) -> None:
    library = built(tmp_path, "linux64", "darwin64")["darwin64"]
    (count,) = struct.unpack_from(">I", library, 4)
    slices = [struct.unpack_from(">IIIII", library, 8 + 20 * k) for k in range(count)]
    assert {machine for machine, *_ in slices} == MACHINES
    for _, _, place, size, _ in slices:
        assert library[place : place + 4] == b"\xcf\xfa\xed\xfe"
        assert place + size <= len(library)


@pytest.mark.slow
def test_windows(tmp_path: Path) -> None:
    """The first time on a machine zig builds its C library for Windows, a minute's work."""
    built(tmp_path, "win64")
