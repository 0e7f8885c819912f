"""Words for messages."""

from __future__ import annotations

from orchestrator.errors import nearest


def test_the_nearest_word_is_named_or_the_first_ones() -> None:
    assert nearest("forse", ["force", "motion"]) == "did you mean 'force'?"
    assert nearest("x", ["motion", "force"]) == "there are force, motion"
    assert nearest("x", []) == "there is none"


def test_endless_words_take_no_time() -> None:
    """Likeness goes with the square of the length: these would take minutes."""
    assert nearest("x" * 300_000, ["y" * 300_000]).startswith("there is yyy")
    assert nearest("x", [f"name{k}" for k in range(300_000)]).endswith(", ...")
