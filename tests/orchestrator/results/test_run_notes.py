"""Remarks on a run, from its file."""

from __future__ import annotations

from typing import Any

import pytest

from orchestrator.results.run_notes import RunNotes, read


def test_remarks_are_read_as_they_were_written() -> None:
    found = read(
        {"verdict": "why", "warnings": '["a: b"]', "changes": '{"a.b": "1 m"}', "dropped": '["c"]'}
    )
    assert found == RunNotes("why", ["a: b"], {"a.b": "1 m"}, ["c"])
    assert found.changed == "a.b = 1 m"


@pytest.mark.parametrize("damaged", ["", "{", "7", '"text"', "[" * 100_000, b"\xff", 3.0])
def test_what_is_damaged_is_left_out(damaged: Any) -> None:
    assert read(dict.fromkeys(("warnings", "changes", "dropped"), damaged)) == RunNotes(
        "", [], {}, []
    )


def test_a_text_of_a_stranger_moves_no_cursor() -> None:
    assert read({"verdict": "\x1b[31mred"}).verdict == "\\x1b[31mred"
