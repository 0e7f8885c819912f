"""Mutators: from one input, another that is a little wrong; always the same for a seed.

Those of bytes know nothing of the format; those of texts work on its tokens, numbers and elements,
so that more of what they make passes the first check of a reader.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from random import Random

Mutator = Callable[[Random, bytes], bytes]

NUMBERS = (
    "0", "-1", "1e308", "-1e308", "5e-324", "1e999", "nan", "-inf", "2147483648", "1e-60",
    "99999999999999999999", "0x10", "1_0", "1,5", "", "1e3.5", "True", "9" * 5000,
)  # fmt: skip
TEXTS = (
    "", " ", "\n", "\0", "\ufeff", "\u202e", "a" * 3000, "[/b]", "$x$", "../../x", "/", "//", "{}",
    "[", "]]", "'", '"', "<", "&amp;", "&x;", "<!DOCTYPE a>", "%s", "time", "*", "%", "#", "a.b.c",
)  # fmt: skip
NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
TOKEN = re.compile(rb"\w+|[^\w\s]")
ATTRIBUTE = re.compile(rb'([\w:]+)="([^"]*)"')
ELEMENT = re.compile(rb"<(\w[\w:]*)\b[^<>]*?(?:/>|>[^<>]*</\1>)")


def flip(random: Random, data: bytes) -> bytes:
    """Some bits the other way."""
    made = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 4, 32))):
        if made:
            made[random.randrange(len(made))] ^= 1 << random.randrange(8)
    return bytes(made)


def cut(random: Random, data: bytes) -> bytes:
    """Less at the end, or in the middle."""
    first, last = sorted(random.randrange(len(data) + 1) for _ in range(2))
    return data[:first] if random.random() < 0.5 else data[:first] + data[last:]


def repeat(random: Random, data: bytes) -> bytes:
    """A stretch of up to 200 bytes twice, the second time somewhere else."""
    first, place = (random.randrange(len(data) + 1) for _ in range(2))
    return data[:place] + data[first : first + random.randrange(200)] + data[place:]


def overwrite(random: Random, data: bytes) -> bytes:
    """A word of 1 to 8 bytes as an extreme whole number."""
    size = random.choice((1, 2, 4, 8))
    place = random.randrange(max(1, len(data) - size))
    word = random.choice((b"\0", b"\xff", b"\x7f", b"\x01")) * size
    return data[:place] + word + data[place + size :]


BYTES: tuple[Mutator, ...] = (flip, cut, repeat, overwrite)


def _replaced(random: Random, data: bytes, pattern: re.Pattern[bytes], word: bytes) -> bytes:
    found = list(pattern.finditer(data))
    if not found:
        return data
    one = random.choice(found)
    return data[: one.start()] + word + data[one.end() :]


def number(random: Random, data: bytes) -> bytes:
    """A number as an extreme one."""
    return _replaced(random, data, NUMBER, random.choice(NUMBERS).encode())


def token(random: Random, data: bytes) -> bytes:
    """A word or sign as another of the same text, as an odd one, or gone."""
    found = TOKEN.findall(data)
    word = random.choice(found) if found and random.random() < 0.5 else None
    return _replaced(random, data, TOKEN, word or random.choice(TEXTS).encode())


def line(random: Random, data: bytes) -> bytes:
    """A line twice, gone, or at another place."""
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    one = random.choice(lines)
    if random.random() < 0.5:
        lines.remove(one)
    if random.random() < 0.7:
        lines.insert(random.randrange(len(lines) + 1), one)
    return b"".join(lines)


TEXT: tuple[Mutator, ...] = (number, token, line, flip, cut)


def attribute(random: Random, data: bytes) -> bytes:
    """An attribute of XML with an odd value, with that of another, or gone."""
    found = list(ATTRIBUTE.finditer(data))
    if not found:
        return data
    one, other = random.choice(found), random.choice(found)
    value = random.choice((other[2], random.choice((*NUMBERS, *TEXTS)).encode()))
    word = random.choice((b'%s="%s"' % (one[1], value), b'%s="%s"' % (other[1], one[2]), b""))
    return data[: one.start()] + word + data[one.end() :]


def element(random: Random, data: bytes) -> bytes:
    """An element of XML gone, twice, or within another."""
    found = list(ELEMENT.finditer(data))
    if not found:
        return data
    one, other = random.choice(found), random.choice(found)
    word = random.choice((b"", one[0] * 2, other[0], b"<a>" * 50 + one[0] + b"</a>" * 50))
    return data[: one.start()] + word + data[one.end() :]


XML: tuple[Mutator, ...] = (attribute, attribute, element, number, token, cut)


def cell(random: Random, data: bytes) -> bytes:
    """A cell of a table with an odd content, one more, or one less."""
    lines = data.split(b"\n")
    place = random.randrange(len(lines))
    cells = lines[place].split(b",")
    k = random.randrange(len(cells))
    word = random.choice((*NUMBERS, *TEXTS)).encode()
    cells[k : k + random.randrange(2)] = [word] * random.randrange(3)
    lines[place] = b",".join(cells)
    return b"\n".join(lines)


CSV: tuple[Mutator, ...] = (cell, cell, number, token, line, flip, cut)


def entry_of(name: str, inner: tuple[Mutator, ...]) -> Mutator:
    """A mutator of the entry of an archive that has this name; of its bytes where there is none."""

    def mutate(random: Random, data: bytes) -> bytes:
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as old:
                entries = {info.filename: old.read(info) for info in old.infolist()}
        except Exception:  # an archive that earlier mutators have damaged
            return flip(random, data)
        if name not in entries:
            return flip(random, data)
        entries[name] = random.choice(inner)(random, entries[name])
        return packed(entries)

    return mutate


def entries(random: Random, data: bytes) -> bytes:
    """An archive with an entry less, or one of another name."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as old:
            kept = {info.filename: old.read(info) for info in old.infolist()}
    except Exception:
        return flip(random, data)
    if not kept:
        return data
    one = random.choice(sorted(kept))
    content = kept.pop(one)
    if random.random() < 0.7:
        kept[random.choice((one.upper(), one + "/", "x" + random.choice(TEXTS), "../" + one))] = (
            content
        )
    return packed(kept)


def packed(contents: dict[str, bytes]) -> bytes:
    """An archive of these entries."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return file.getvalue()
