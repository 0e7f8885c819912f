"""Lines of a text file, whatever ends them and however it is encoded, numbered from 1."""

from __future__ import annotations

import codecs
import io
from collections.abc import Iterator
from pathlib import Path

from ..errors import RecordingError, printable

COMMENTS = ("#", "%")
LONGEST_LINE = 1 << 20
MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""First bytes of a file -> its encoding, the longer mark first."""


def text_lines(path: Path, encoding: str = "") -> Iterator[tuple[int, str]]:
    """Number and text of each line; UTF-8 unless the file's first bytes or `encoding` differ.

    Raises :class:`RecordingError` with the line that is not text in that encoding.
    """
    with path.open("rb") as file:
        head = file.read(4)
        file.seek(0)
        code = encoding or next((c for mark, c in MARKS.items() if head.startswith(mark)), "utf-8")
        source: io.BufferedIOBase = file
        try:
            if codecs.lookup(code).name.startswith(("utf-16", "utf-32")):
                source = io.BytesIO(file.read().decode(code).lstrip("\ufeff").encode())
                code = "utf-8"
        except LookupError:
            raise RecordingError(
                f"{path}: encoding: {printable(encoding)!r} is not known; use utf-8, cp1252, utf-16"
            ) from None
        except UnicodeDecodeError as error:
            raise RecordingError(
                f"{path}: is not {code} at its byte {error.start + 1}; give the right encoding"
            ) from None
        for number, raw in enumerate(_raw(source), start=1):
            text = _decoded(path, number, raw, code).strip("\r\n")
            if "\0" in text or len(raw) >= LONGEST_LINE:
                raise RecordingError(f"{path}: line {number}: is not text of a table")
            yield number, text.removeprefix("\ufeff") if number == 1 else text


def _raw(file: io.BufferedIOBase) -> Iterator[bytes]:
    """Lines with their ends: LF, CR LF, or CR alone."""
    rest = b""
    while chunk := file.read(LONGEST_LINE):
        *lines, rest = (rest + chunk).splitlines(keepends=True)
        yield from lines
        if len(rest) >= LONGEST_LINE:
            break
    if rest:
        yield rest


def _decoded(path: Path, number: int, raw: bytes, code: str) -> str:
    try:
        return raw.decode(code)
    except UnicodeDecodeError as error:
        raise RecordingError(
            f"{path}: line {number}: is not {code.upper()} at its byte {error.start + 1}"
            f' (0x{raw[error.start]:02x}); save it as UTF-8, or give encoding = "cp1252" or another'
        ) from None
