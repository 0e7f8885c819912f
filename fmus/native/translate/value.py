"""The C text of an expression, with what has to be known to use it in a larger one."""

from __future__ import annotations

from dataclasses import dataclass, field

from .kinds import Kind, Table, View

ATOM, UNARY, PRODUCT, SUM, ORDER, EQUAL, AND, OR, CHOICE = range(9)
"""How tightly a text holds together, from what needs no brackets to what needs them most."""

NOTHING: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Value:
    """An expression.

    `causes` are the errors that it raises where it stands. `constant` is its value where that is
    known; `below` is a length within which an index is sure to be. `place` says what the text of a
    struct is: "value", "variable" (which has an address), "pointer". `simple` texts cost nothing to
    evaluate twice.
    """

    text: str
    kind: Kind
    rank: int = ATOM
    causes: frozenset[str] = field(default=NOTHING)
    constant: float | None = None
    place: str = "value"
    simple: bool = False
    below: int | None = None

    def within(self, rank: int) -> str:
        """The text for a place that takes what holds together at least so tightly."""
        return self.text if self.rank <= rank else f"({self.text})"

    @property
    def plain(self) -> str:
        """The text of the value itself, whatever a struct's place is."""
        return f"*{self.text}" if self.place == "pointer" else self.text

    def member(self, name: str) -> str:
        """Text of a member of a struct."""
        arrow = "->" if self.place == "pointer" else "."
        return f"{self.text}{arrow}{name}"


def viewed(found: Value) -> Value:
    """A table of known shape as one that can be handed on; anything else as it is."""
    if not isinstance(found.kind, Table):
        return found
    shape = found.kind.shape
    first = found.text if len(shape) == 1 else f"(const double *){found.text}"
    sizes = ", ".join(str(size) for size in shape)
    name = "Row" if len(shape) == 1 else "Table"
    return Value(f"({name}){{{first}, {sizes}}}", View(len(shape)), ATOM, found.causes)
