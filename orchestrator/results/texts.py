"""Recorded texts: String variables, noted where they change."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Change = tuple[float, str]
"""A time [s], and the text that holds from there on."""


class Texts:
    """Changes of each recorded text, by `component.variable`."""

    def __init__(self, names: Iterable[str]) -> None:
        self.changes: dict[str, list[Change]] = {name: [] for name in names}

    def note(self, name: str, time: float, text: str) -> bool:
        """Note what a text is at a time, after all noted before; whether it has changed."""
        noted = self.changes[name]
        changed = not noted or noted[-1][1] != text
        if changed:
            noted.append((time, text))
        return changed

    def clear(self) -> None:
        """Forget all: the run begins anew."""
        for noted in self.changes.values():
            noted.clear()


def changes_of(times: NDArray[np.float64], texts: NDArray[Any]) -> list[Change]:
    """The changes of a text that is known at each of these times."""
    known = Texts([""])
    for time, text in zip(times, texts, strict=True):
        known.note("", float(time), str(text))
    return known.changes[""]


def texts_at(changes: Sequence[Change], times: NDArray[np.float64]) -> NDArray[Any]:
    """The text at each of these times; "" before the first change."""
    begins = [time for time, _ in changes]
    known = np.array(["", *(text for _, text in changes)], dtype=object)
    return np.asarray(known[np.searchsorted(begins, times, side="right")])
