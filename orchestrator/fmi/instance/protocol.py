"""Frames between a master and the process of an isolated instance.

A command is one letter, the length of its payload, and the payload: JSON or raw doubles. An
answer is a letter (`k` done, `f` the FMU failed, `e` it cannot be used), the lengths of its text
and its values, and both. Nothing is unpickled: the other side may run any code.
"""

from __future__ import annotations

import json
import os
import struct
from dataclasses import dataclass
from typing import Any

COMMAND = struct.Struct("<cI")
ANSWER = struct.Struct("<cII")
STEP = struct.Struct("<dd?")
"""Time, size, and whether inputs follow."""
MOST_BYTES = 1 << 26


class Gone(Exception):
    """The other side has closed the pipe."""


class Garbled(Exception):
    """What came through the pipe is not an answer."""


def read_exactly(descriptor: int, count: int) -> bytes:
    """`count` bytes from a pipe; `Gone` where it ends."""
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
    """Write all bytes into a pipe; `Gone` where its other end is closed."""
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


@dataclass(frozen=True)
class Log:
    """What an instance has reported since the last answer: messages with their status, warnings."""

    messages: list[tuple[int, str]]
    warned: int


def read_answer(descriptor: int) -> tuple[bytes, Any, Log, bytes]:
    """Letter, text, log and values of an answer; `Garbled` where it is not one."""
    letter, words, values = ANSWER.unpack(read_exactly(descriptor, ANSWER.size))
    if letter not in (b"k", b"f", b"e") or max(words, values) > MOST_BYTES:
        raise Garbled
    try:
        found = json.loads(read_exactly(descriptor, words)) if words else {}
        text = found.get("text")
        messages = [(int(status), str(words)) for status, words in found.get("messages", [])]
        log = Log(messages, int(found.get("warned", 0)))
    except (ValueError, TypeError, AttributeError, RecursionError):
        raise Garbled from None
    return letter, text, log, read_exactly(descriptor, values)


class Frames:
    """Answers as they come in pieces: letter, what is told, and values of each whole one."""

    def __init__(self) -> None:
        self._waiting = bytearray()

    def feed(self, data: bytes) -> list[tuple[bytes, Any, bytes]]:
        """Those that are whole with these bytes; `Garbled` where one is none."""
        self._waiting += data
        whole = []
        while len(self._waiting) >= ANSWER.size:
            letter, words, values = ANSWER.unpack_from(self._waiting)
            if max(words, values) > MOST_BYTES:
                raise Garbled
            middle, end = ANSWER.size + words, ANSWER.size + words + values
            if len(self._waiting) < end:
                break
            try:
                told = json.loads(self._waiting[ANSWER.size : middle]) if words else None
            except (ValueError, RecursionError):
                raise Garbled from None
            whole.append((letter, told, bytes(self._waiting[middle:end])))
            del self._waiting[:end]
        return whole
