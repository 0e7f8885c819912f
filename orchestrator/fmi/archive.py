"""The one way into an FMU or SSP file: entries are checked before anything is written.

Refused: entries that would leave the folder, links and devices, duplicates and case twins,
names that no file system should hold, bombs by declared size, ratio or count, truncated, damaged
and encrypted archives, and what is not an archive at all.
"""

from __future__ import annotations

import stat
import unicodedata
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from ..errors import FmuError, printable

MOST_BYTES = 512 * 1024 * 1024
MOST_DESCRIPTION = 32 * 1024 * 1024
MOST_ENTRIES = 10_000
MOST_RATIO = 200
RATIO_COUNTS_FROM = 1024 * 1024
LONGEST_NAME = 240
DEEPEST = 32
LONGEST_PATH = 1000
CHUNK = 1 << 20
ENCRYPTED = 0x1
DESCRIPTION = "modelDescription.xml"
STRUCTURE = "SystemStructure.ssd"
KINDS = {DESCRIPTION: "an FMU", STRUCTURE: "an SSP"}
"""Entry that an archive must have at its top level -> the kind of file that makes it."""


def read_description(path: Path) -> bytes:
    """Bytes of the model description of an FMU file, after all checks of its archive."""
    return read_entry(path, DESCRIPTION, DESCRIPTION)


def read_entry(path: Path, name: str, kind: str) -> bytes:
    """Bytes of one text of an archive of a kind, which is the entry that it must have (`KINDS`)."""
    with _opened(path, kind) as archive:
        if name not in archive.namelist():
            raise FmuError(f"{path}: has no '{printable(name)}'")
        info = archive.getinfo(name)
        if info.file_size > MOST_DESCRIPTION:
            raise FmuError(
                f"{path}: {name} has {info.file_size >> 20} MiB;"
                f" at most {MOST_DESCRIPTION >> 20} MiB are read"
            )
        return _content(path, archive, info)


def entries(path: Path, kind: str) -> list[str]:
    """Names of all entries of an archive."""
    with _opened(path, kind) as archive:
        return archive.namelist()


def extract(path: Path, folder: Path, kind: str = DESCRIPTION) -> None:
    """Unpack an archive into an existing empty folder."""
    with _opened(path, kind) as archive:
        for info in archive.infolist():
            target = folder / info.filename
            text = b"" if info.is_dir() else _content(path, archive, info)
            try:
                (target if info.is_dir() else target.parent).mkdir(parents=True, exist_ok=True)
                if not info.is_dir():
                    target.write_bytes(text)
            except OSError as error:
                raise FmuError(
                    f"{path}: cannot be unpacked into {folder} ({error.strerror});"
                    " make room there, or set TMPDIR to another folder"
                ) from None


def platforms(path: Path) -> list[str]:
    """Platforms for which the archive holds binaries, by folder name."""
    with _opened(path) as archive:
        parts = [PurePosixPath(name).parts for name in archive.namelist()]
    return sorted({p[1] for p in parts if len(p) > 2 and p[0] == "binaries"})


@contextmanager
def _opened(path: Path, kind: str = DESCRIPTION) -> Iterator[zipfile.ZipFile]:
    """Archive with all its entries checked."""
    try:
        mode = stat.S_IFMT(path.stat().st_mode)
        if mode == stat.S_IFDIR:
            raise FmuError(f"{path}: is a folder, not {KINDS[kind]} file")
        if mode != stat.S_IFREG:
            raise FmuError(f"{path}: is not a plain file")
        archive = zipfile.ZipFile(path)
    except FileNotFoundError:
        raise FmuError(f"{path}: no such file") from None
    except OSError as error:
        raise FmuError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise FmuError(f"{printable(str(path))}: no such file ({error})") from None
    except (zipfile.BadZipFile, NotImplementedError) as error:
        raise FmuError(f"{path}: not a zip archive, {_look(path)} ({error})") from None
    with archive:
        _check(path, archive.infolist(), kind)
        yield archive


def _look(path: Path) -> str:
    """Size and first bytes of a file, for the message."""
    with path.open("rb") as file:
        head = file.read(8)
    return f"{path.stat().st_size} bytes, starting with {head!r}"


def _is_place_taken(name: str, folders: set[str], files: set[str]) -> bool:
    """Whether an entry is a file where another needs a folder, or the other way round."""
    parts = name.casefold().rstrip("/").split("/")
    above = {"/".join(parts[:k]) for k in range(1, len(parts))}
    own = "/".join(parts)
    taken = bool(above & files) or (own in folders and not name.endswith("/"))
    folders |= above
    (folders if name.endswith("/") else files).add(own)
    return taken


def _check(path: Path, entries: list[zipfile.ZipInfo], kind: str) -> None:
    """Refuse archives that are not plain trees of files of acceptable size."""
    if len(entries) > MOST_ENTRIES:
        raise FmuError(f"{path}: {len(entries)} entries; at most {MOST_ENTRIES} are read")
    declared = sum(info.file_size for info in entries)
    if declared > MOST_BYTES:
        raise FmuError(f"{path}: declares {declared} bytes; at most {MOST_BYTES} are unpacked")
    seen: set[str] = set()
    folders: set[str] = set()
    files: set[str] = set()
    for info in entries:
        name = info.orig_filename
        fault = _fault_of_name(name) or _fault_of_entry(info)
        key = unicodedata.normalize("NFC", name).casefold().rstrip("/")
        if not fault and key in seen:
            fault = "is duplicated, or differs from another only in case"
        if not fault and _is_place_taken(name, folders, files):
            fault = "is a file where another entry needs a folder"
        seen.add(key)
        if fault:
            raise FmuError(f"{path}: entry '{printable(name)}' {fault}")
    if kind not in {info.filename for info in entries}:
        raise FmuError(f"{path}: not {KINDS[kind]}: no {kind} at its top level")


def _fault_of_name(name: str) -> str:
    """What is wrong with an entry's name, or nothing."""
    if len(name) > LONGEST_PATH:
        return "has a name too long for a file system"
    if not name or not name.isprintable() or printable(name, most=LONGEST_PATH) != name:
        return "has an unprintable name"
    if "\\" in name or ":" in name or name.startswith("/"):
        return "has an absolute path, a drive or a backslash"
    parts = name.rstrip("/").split("/")
    if any(part in {"", ".", ".."} for part in parts):
        return "leaves its folder"
    if len(parts) > DEEPEST:
        return "is nested too deeply"
    if any(len(part.encode()) > LONGEST_NAME for part in parts):
        return "has a name too long for a file system"
    return ""


def _fault_of_entry(info: zipfile.ZipInfo) -> str:
    """What is wrong with an entry apart from its name, or nothing."""
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind not in {0, stat.S_IFREG, stat.S_IFDIR}:
        return "is a link or a device"
    if info.flag_bits & ENCRYPTED:
        return "is encrypted"
    if info.compress_type not in {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
        return "is compressed with a method other than deflate"
    if info.file_size > RATIO_COUNTS_FROM and info.file_size > MOST_RATIO * info.compress_size:
        return f"is compressed more than {MOST_RATIO} times"
    return ""


def _content(path: Path, archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    """Bytes of one entry, never more than it declares."""
    try:
        with archive.open(info) as file:
            pieces = []
            left = info.file_size
            while piece := file.read(min(CHUNK, left + 1)):
                left -= len(piece)
                if left < 0:
                    raise FmuError(f"{path}: entry '{info.filename}' is larger than declared")
                pieces.append(piece)
            if left:
                raise FmuError(f"{path}: entry '{info.filename}' is shorter than declared")
            return b"".join(pieces)
    except (zipfile.BadZipFile, EOFError, OSError, NotImplementedError, RuntimeError) as error:
        raise FmuError(f"{path}: entry '{info.filename}' is damaged ({error})") from None
    except Exception as error:
        if isinstance(error, FmuError):
            raise
        raise FmuError(f"{path}: entry '{info.filename}' cannot be unpacked ({error})") from None
