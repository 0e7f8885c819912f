"""Bytes from the process of an isolated instance that are not an answer."""

from __future__ import annotations

import os

import pytest

from orchestrator.fmi.instance.protocol import ANSWER, Garbled, read_answer


@pytest.mark.parametrize(
    "answer",
    [
        b"z" + 8 * b"\0",
        b"k" + b"\xff" * 8,
        ANSWER.pack(b"k", 3, 0) + b"[1]",
        ANSWER.pack(b"k", 2, 0) + b"{]",
        ANSWER.pack(b"f", 40_000, 0) + 40_000 * b"[",
        ANSWER.pack(b"k", 15, 0) + b'{"messages": 3}',
    ],
    ids=["letter", "lengths", "list", "no JSON", "depth", "messages"],
)
def test_what_is_not_an_answer_is_refused(answer: bytes) -> None:
    """The process of an isolated instance may send anything."""
    reading, writing = os.pipe()
    try:
        os.write(writing, answer)
        with pytest.raises(Garbled):
            read_answer(reading)
    finally:
        os.close(reading)
        os.close(writing)
