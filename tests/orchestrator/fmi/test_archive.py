"""What an FMU file may not do to its reader: faults of the archive, each refused by name.

The zip files are written byte by byte, since a library would not write most of them.
"""

from __future__ import annotations

import errno
import itertools
import os
import random
import stat
import struct
import zlib
from bz2 import compress as bz2
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from lzma import FORMAT_RAW
from lzma import compress as lzma
from pathlib import Path

import pytest

from orchestrator.errors import FmuError, ResilinError
from orchestrator.fmi.archive import (
    DESCRIPTION,
    LONGEST_NAME,
    MOST_BYTES,
    MOST_ENTRIES,
    extract,
    platforms,
    read_description,
)
from orchestrator.fmi.description import read_interface

STORED, DEFLATED, BZIP2, LZMA = 0, 8, 12, 14
ENCRYPTED, UTF8 = 0x1, 0x800
TEXT = b"<fmiModelDescription/>"


@dataclass(frozen=True)
class Entry:
    """One entry of a zip file; what is not given is right."""

    name: bytes
    data: bytes = b"x"
    method: int = STORED
    flags: int = UTF8
    mode: int = stat.S_IFREG | 0o644
    size: int | None = None
    crc: int | None = None
    packed: bytes | None = None

    def parts(self) -> tuple[bytes, int, int]:
        """Packed bytes, checksum and declared size."""
        packed = self.data if self.packed is None else self.packed
        if self.method == DEFLATED and self.packed is None:
            deflate = zlib.compressobj(9, zlib.DEFLATED, -15)
            packed = deflate.compress(self.data) + deflate.flush()
        crc = zlib.crc32(self.data) if self.crc is None else self.crc
        return packed, crc, len(self.data) if self.size is None else self.size


def zipped(path: Path, entries: Sequence[Entry]) -> Path:
    """Write a zip file with exactly these entries, good or bad."""
    local, central = bytearray(), bytearray()
    for entry in entries:
        packed, crc, size = entry.parts()
        common = struct.pack(
            "<HHHHIIIHH",
            *(entry.flags, entry.method, 0, 0x21, crc),
            *(len(packed), size, len(entry.name), 0),
        )
        start = len(local)
        local += b"PK\x03\x04" + struct.pack("<H", 20) + common + entry.name + packed
        central += b"PK\x01\x02" + struct.pack("<HH", 3 << 8 | 20, 20) + common
        central += struct.pack("<HHHII", 0, 0, 0, entry.mode << 16, start) + entry.name
    count = min(len(entries), 0xFFFF)
    end = struct.pack("<HHHHIIH", 0, 0, count, count, len(central), len(local), 0)
    path.write_bytes(bytes(local + central) + b"PK\x05\x06" + end)
    return path


def fmu(tmp_path: Path, *entries: Entry) -> Path:
    """A small archive with a description, and these entries beside it."""
    return zipped(tmp_path / "bad.fmu", [Entry(DESCRIPTION.encode(), TEXT), *entries])


def refused(path: Path, folder: Path) -> str:
    """The one message with which every way into the archive refuses it and leaves no file."""
    folder.mkdir()
    ways: list[Callable[[], object]] = [
        lambda: read_interface(path),
        lambda: platforms(path),
        lambda: extract(path, folder),
    ]
    messages = []
    for way in ways:
        with pytest.raises(FmuError) as caught:
            way()
        messages.append(str(caught.value))
    assert len(set(messages)) == 1
    assert list(folder.iterdir()) == []
    assert messages[0].startswith(f"{path}: ")
    assert messages[0].isprintable()
    return messages[0]


@pytest.fixture
def payload_fmu(library: Path) -> Path:
    """A real FMU."""
    return library / "payload.fmu"


def test_good_archive_is_unpacked_whole(payload_fmu: Path, tmp_path: Path) -> None:
    extract(payload_fmu, tmp_path)
    assert (tmp_path / DESCRIPTION).read_bytes() == read_description(payload_fmu)
    assert "linux64" in platforms(payload_fmu)


def test_harmless_entries_are_read(tmp_path: Path) -> None:
    path = fmu(
        tmp_path,
        Entry(b"resources/", b"", mode=stat.S_IFDIR | 0o755),
        Entry("resources/naïve name 翼.txt".encode()),
        Entry(b"resources/..hidden..", b"x" * 5000, method=DEFLATED, mode=0),
    )
    folder = tmp_path / "out"
    folder.mkdir()
    extract(path, folder)
    assert (folder / "resources" / "naïve name 翼.txt").read_bytes() == b"x"
    assert (folder / "resources" / "..hidden..").stat().st_size == 5000


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        (b"../evil", "leaves its folder"),
        (b"a/../../evil", "leaves its folder"),
        (b"a/..", "leaves its folder"),
        (b"./evil", "leaves its folder"),
        (b"a//b", "leaves its folder"),
        (b"/etc/evil", "absolute"),
        (b"//host/share", "absolute"),
        (b"C:/evil", "drive"),
        (b"C:evil", "drive"),
        (b"file:stream", "drive"),
        (b"..\\evil", "backslash"),
        (b"\\\\host\\share", "backslash"),
        (b"nul\0../../evil", "unprintable"),
        (b"modelDescription.xml\0", "unprintable"),
        (b"esc\x1b[31m", "unprintable"),
        (b"line\nbreak", "unprintable"),
        (b"\x7f", "unprintable"),
        ("bidi\u202egnp.exe".encode(), "unprintable"),
        ("zero\u200bwidth".encode(), "unprintable"),
        (b"", "unprintable"),
        (b"n" * (LONGEST_NAME + 1), "too long"),
        ("翼".encode() * (LONGEST_NAME // 3 + 1), "too long"),
        (b"d/" * 600 + b"x", "too long"),
        (b"d/" * 200 + b"x", "d/d/d"),
    ],
)
def test_name_is_refused(name: bytes, reason: str, tmp_path: Path) -> None:
    path = fmu(tmp_path, Entry(name))
    assert reason in refused(path, tmp_path / "out")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.fmu", "out"]


@pytest.mark.parametrize(
    "kind", [stat.S_IFLNK, stat.S_IFCHR, stat.S_IFBLK, stat.S_IFIFO, stat.S_IFSOCK]
)
def test_link_or_device_is_refused(kind: int, tmp_path: Path) -> None:
    path = fmu(tmp_path, Entry(b"resources/link", b"/etc/passwd", mode=kind | 0o777))
    message = refused(path, tmp_path / "out")
    assert "resources/link" in message
    assert "link or a device" in message


@pytest.mark.parametrize(
    "names",
    [
        (b"a.txt", b"a.txt"),
        (b"x", b"x"),
        (b"modelDescription.xml",),
        (b"MODELDESCRIPTION.XML",),
        (b"resources/A.txt", b"resources/a.TXT"),
        (b"resources", b"resources/"),
        ("straße".encode(), b"STRASSE"),
    ],
)
def test_twins_are_refused(names: tuple[bytes, ...], tmp_path: Path) -> None:
    path = fmu(tmp_path, *map(Entry, names))
    assert "is duplicated" in refused(path, tmp_path / "out")


def test_file_in_the_place_of_a_folder_is_refused(tmp_path: Path) -> None:
    path = fmu(tmp_path, Entry(b"resources"), Entry(b"resources/inner"))
    with pytest.raises(FmuError, match="resources"):
        extract(path, tmp_path)


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        (Entry(b"bomb", b"x" * 100, size=2 << 30), "declares 2147483"),
        (Entry(b"bomb", size=0xFFFFFFFE), "declares 4294967"),
        (Entry(b"bomb", bytes(4 << 20), DEFLATED), "compressed more than"),
        (Entry(b"bomb", b"", DEFLATED, size=MOST_BYTES // 2), "compressed more than"),
    ],
)
def test_bomb_is_refused_by_what_it_declares(entry: Entry, reason: str, tmp_path: Path) -> None:
    assert reason in refused(fmu(tmp_path, entry), tmp_path / "out")


def test_many_small_bombs_are_refused_by_their_sum(tmp_path: Path) -> None:
    bombs = [Entry(b"b%d" % k, b"", size=1 << 20) for k in range((MOST_BYTES >> 20) + 1)]
    assert "declares" in refused(fmu(tmp_path, *bombs), tmp_path / "out")


def test_too_many_entries_are_refused(tmp_path: Path) -> None:
    path = fmu(tmp_path, *(Entry(b"e%d" % k, b"") for k in range(MOST_ENTRIES)))
    assert f"{MOST_ENTRIES + 1} entries" in refused(path, tmp_path / "out")


@pytest.mark.parametrize(
    ("method", "packed"),
    [
        (BZIP2, bz2(bytes(100))),
        (LZMA, b"\x09\x04\x05\x00" + lzma(bytes(100), FORMAT_RAW, filters=[{"id": 0x21}])),
        (99, b"?"),
    ],
    ids=["bzip2", "lzma", "unknown"],
)
def test_only_stored_and_deflated_entries_are_read(
    method: int, packed: bytes, tmp_path: Path
) -> None:
    """Other methods unpack without a bound on memory, and FMI does not have them."""
    path = fmu(tmp_path, Entry(b"resources/data", bytes(100), method, packed=packed))
    message = refused(path, tmp_path / "out")
    assert "resources/data" in message
    assert "deflate" in message


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        (Entry(b"data", crc=1), "damaged"),
        (Entry(b"data", b"x" * 99, DEFLATED, crc=1), "damaged"),
        (Entry(b"data", b"x" * 99, DEFLATED, size=10), "damaged"),
        (Entry(b"data", b"x" * 99, DEFLATED, size=1000), "damaged|shorter"),
        (Entry(b"data", b"x" * 99, DEFLATED, packed=b"\xff" * 20), "damaged|cannot be unpacked"),
        (Entry(b"data", b"x" * 99, DEFLATED, packed=b""), "damaged|cannot be unpacked"),
    ],
    ids=["crc", "deflated-crc", "larger", "smaller", "no-deflate", "empty"],
)
def test_damaged_entry_is_named(entry: Entry, reason: str, tmp_path: Path) -> None:
    path = fmu(tmp_path, entry)
    with pytest.raises(FmuError, match=rf"bad\.fmu: entry 'data' .*({reason})"):
        extract(path, tmp_path)
    assert not (tmp_path / "data").exists()


def test_damaged_description_is_named(tmp_path: Path) -> None:
    path = zipped(tmp_path / "bad.fmu", [Entry(DESCRIPTION.encode(), TEXT, crc=1)])
    with pytest.raises(FmuError, match=DESCRIPTION):
        read_interface(path)


def test_encrypted_entry_is_refused(tmp_path: Path) -> None:
    path = fmu(tmp_path, Entry(b"secret", flags=UTF8 | ENCRYPTED))
    assert "is encrypted" in refused(path, tmp_path / "out")


@pytest.mark.parametrize("names", [[], [b"readme.txt"], [b"sub/modelDescription.xml"]])
def test_archive_without_description_is_not_an_fmu(names: list[bytes], tmp_path: Path) -> None:
    path = zipped(tmp_path / "bad.fmu", list(map(Entry, names)))
    assert "not an FMU" in refused(path, tmp_path / "out")


@pytest.mark.parametrize(
    ("content", "head"),
    [
        (b"", "0 bytes, starting with b''"),
        (b"PK", "2 bytes, starting with b'PK'"),
        (b"\x7fELF\x1b[31mrest of it", r"19 bytes, starting with b'\x7fELF\x1b[31'"),
        (b"<html>" * 1000, "6000 bytes, starting with b'<html><h'"),
    ],
)
def test_what_is_not_a_zip_is_shown(content: bytes, head: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.fmu"
    path.write_bytes(content)
    assert head in refused(path, tmp_path / "out")


@pytest.mark.parametrize("kept", [0.01, 0.5, 0.9, 0.999])
def test_truncated_archive_is_refused(kept: float, payload_fmu: Path, tmp_path: Path) -> None:
    whole = payload_fmu.read_bytes()
    path = tmp_path / "bad.fmu"
    path.write_bytes(whole[: int(kept * len(whole))])
    assert "not a zip archive" in refused(path, tmp_path / "out")


@pytest.mark.parametrize("name", ["missing.fmu", "n" * 300 + ".fmu", "nul\0.fmu"])
def test_path_that_leads_nowhere(name: str, tmp_path: Path) -> None:
    with pytest.raises(FmuError, match=r"\.fmu"):
        read_interface(tmp_path / name)


def test_folder_is_not_an_fmu(tmp_path: Path) -> None:
    with pytest.raises(FmuError, match="folder"):
        read_interface(tmp_path)


def test_pipe_is_refused_without_waiting(tmp_path: Path) -> None:
    path = tmp_path / "bad.fmu"
    os.mkfifo(path)
    with pytest.raises(FmuError, match="file"):
        read_interface(path)


def test_full_disk_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: Path, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self))

    path = fmu(tmp_path)
    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(ResilinError, match="No space left"):
        extract(path, tmp_path)


def test_description_too_large_to_parse_is_refused(tmp_path: Path) -> None:
    """A tree of elements takes some forty times the memory of its text."""
    filling = b"<a>" + b" " * 9_000_000 + b"</a>"
    text = b"<fmiModelDescription>" + 8 * filling + b"</fmiModelDescription>"
    path = zipped(tmp_path / "bad.fmu", [Entry(DESCRIPTION.encode(), text)])
    with pytest.raises(FmuError, match=rf"{DESCRIPTION}.*MiB"):
        read_interface(path)


@pytest.mark.parametrize("seed", range(5))
def test_damage_anywhere_is_a_typed_error(seed: int, tmp_path: Path) -> None:
    """Flipped, cut and doubled bytes: read as it was, or refused; never another exception."""
    good = fmu(tmp_path, Entry(b"resources/a", b"abc" * 99, DEFLATED), Entry(b"b/")).read_bytes()
    chance = random.Random(seed)
    path = tmp_path / "mutated.fmu"
    refusals = itertools.count()
    for trial in range(200):
        data = bytearray(good)
        for _ in range(chance.randint(1, 4)):
            data[chance.randrange(len(data))] = chance.choice([0, 0xFF, chance.randrange(256)])
        path.write_bytes(data[: chance.choice([len(data), chance.randrange(len(data))])])
        folder = tmp_path / f"out{trial}"
        folder.mkdir()
        try:
            extract(path, folder)
        except FmuError as error:
            assert str(error).isprintable()
            next(refusals)
    assert next(refusals) > 100
    assert {p.name for p in tmp_path.iterdir() if not p.name.startswith("out")} == {
        "bad.fmu",
        "mutated.fmu",
    }
