"""Frames between a master and the process of an isolated unit.

A command is one letter, the length of what follows, JSON or raw doubles. An answer is a letter
(`k` done, `f` the unit failed, `e` it cannot be used), the lengths of its text and its
values, and both. Nothing is unpickled: the other side may be anybody's code.
"""

from __future__ import annotations

import json
import os
import struct
from typing import Any

COMMAND = struct.Struct("<cI")
ANSWER = struct.Struct("<cII")
STEP = struct.Struct("<dd?")
"""Time, size, and whether inputs follow."""
MOST_BYTES = 1 << 26


class Gone(Exception):
    """The other side has closed the pipe."""


class Garbled(Exception):
    """What came through the pipe is no answer."""


def read_exactly(descriptor: int, count: int) -> bytes:
    """So many bytes from a pipe; `Gone` where it ends."""
    chunk = os.read(descriptor, count) if count else b""
    if len(chunk) == count:
        return chunk
    parts = [chunk]
    have = len(chunk)
    while have < count:
        if not parts[-1]:
            raise Gone
        parts.append(os.read(descriptor, count - have))
        have += len(parts[-1])
    return b"".join(parts)


def write_all(descriptor: int, data: bytes) -> None:
    """All bytes into a pipe; `Gone` where nobody reads."""
    try:
        while data:
            data = data[os.write(descriptor, data) :]
    except OSError:
        raise Gone from None


def command(letter: bytes, payload: bytes = b"") -> bytes:
    return COMMAND.pack(letter, len(payload)) + payload


def answer(letter: bytes, text: Any = None, values: bytes = b"") -> bytes:
    words = b"" if text is None else json.dumps(text).encode()
    return ANSWER.pack(letter, len(words), len(values)) + words + values


def read_answer(descriptor: int) -> tuple[bytes, Any, list[str], bytes]:
    """Letter, what is said, messages and values of an answer; `Garbled` where it is none."""
    letter, words, values = ANSWER.unpack(read_exactly(descriptor, ANSWER.size))
    if letter not in (b"k", b"f", b"e") or max(words, values) > MOST_BYTES:
        raise Garbled
    try:
        text = json.loads(read_exactly(descriptor, words)) if words else {}
        said, messages = text.get("said"), [str(m) for m in text.get("messages", [])]
    except (ValueError, TypeError, AttributeError, RecursionError):
        raise Garbled from None
    return letter, said, messages, read_exactly(descriptor, values)
