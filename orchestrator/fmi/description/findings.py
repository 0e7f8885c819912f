"""What a model description does against the standard: what refuses it, and what is read past."""

from __future__ import annotations

from typing import Any


class Findings:
    """Faults of one description, each with its line.

    An error concerns what names, references or types depend on: a run would be wrong. A warning
    changes no number; each kind appears once, at its first place, with the count of the others.
    """

    def __init__(self) -> None:
        self.errors: list[str] = []
        self._warned: dict[str, tuple[str, int]] = {}

    def refuse(self, element: Any, text: str) -> None:
        """Add an error at an element."""
        self.errors.append(f"line {element.sourceline}: {text}")

    def warn(self, line: int | str, text: str, kind: str = "") -> None:
        """Add a warning at a line; further ones of the same kind are counted."""
        first, count = self._warned.get(kind or text, (f"line {line}: {text}", 0))
        self._warned[kind or text] = first, count + 1

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings, in the order in which their kinds were met."""
        return tuple(
            f"{text} ({count - 1} more like it)" if count > 1 else text
            for text, count in self._warned.values()
        )
