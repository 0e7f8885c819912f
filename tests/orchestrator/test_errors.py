"""Words for messages."""

from __future__ import annotations

from orchestrator.errors import nearest


def test_the_nearest_word_is_named_or_the_first_ones() -> None:
    assert nearest("forse", ["force", "motion"]) == "did you mean 'force'?"
    assert nearest("x", ["motion", "force"]) == "there are force, motion"
    assert nearest("x", []) == "there is none"


def test_names_like_the_word_come_first_and_some_come_last() -> None:
    words = ["alpha", "beta", "supply_voltage_limit"]
    told = nearest("voltage", words, later=["b.one", "a.one"])
    assert told == "there are supply_voltage_limit, alpha, beta, a.one, b.one"
    told = nearest("charge", ["mass"], later=["a.b.alpha", "a.b.some.charge"])
    assert told == "there are mass, a.b.some.charge, a.b.alpha"


def test_endless_words_take_no_time() -> None:
    """Likeness goes with the square of the length: these would take minutes."""
    assert nearest("x" * 300_000, ["y" * 300_000]).startswith("there is yyy")
    assert nearest("x", [f"name{k}" for k in range(300_000)]).endswith(", ...")
