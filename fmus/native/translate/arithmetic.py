"""Floats in C: plain numbers, or dual ones, which carry a derivative along with the value."""

from __future__ import annotations

from .value import ATOM, ORDER, PRODUCT, SUM, UNARY, Value

RANKS = {"+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT}
CONSTANT = "dual_constant("
WORDS = {"+": "sum", "-": "difference", "*": "product", "/": "ratio"}


class Plain:
    """Floats as `double`, under the signs of C."""

    number = "double"
    storage = "static inline"
    declared = "static"

    def record(self, name: str) -> str:
        """Name of a struct of floats."""
        return name

    def function(self, name: str) -> str:
        """Name of a function of floats."""
        return name

    def constant(self, text: str) -> tuple[str, int]:
        """A double that depends on nothing, and how tightly its text holds together."""
        return text, UNARY if text.startswith(("-", "(double)")) else ATOM

    def value(self, found: Value, rank: int = ORDER) -> str:
        """The double of a float."""
        return found.within(rank)

    def negative(self, found: Value) -> tuple[str, int]:
        text = found.within(UNARY)
        return (f"-({text})" if text.startswith("-") else f"-{text}"), UNARY

    def combined(self, sign: str, left: Value, right: Value) -> tuple[str, int]:
        """Two floats under a sign that cannot fail."""
        rank = RANKS[sign]
        return f"{left.within(rank)} {sign} {right.within(rank - 1)}", rank


class Dual(Plain):
    """Floats as `Dual` of `dual.h`: each function gives the value and its derivative.

    They are called now and then: the compiler is to spend its room on the plain ones.
    """

    number = "Dual"
    storage = declared = "static RARE"

    def record(self, name: str) -> str:
        return f"Dual{name}"

    def function(self, name: str) -> str:
        return f"dual_{name}"

    def constant(self, text: str) -> tuple[str, int]:
        return f"{CONSTANT}{text})", ATOM

    def value(self, found: Value, rank: int = ORDER) -> str:
        if found.constant is not None and rank > ATOM and found.text.startswith(CONSTANT):
            return found.text.removeprefix(CONSTANT)[:-1]
        return f"{found.within(ATOM)}.value"

    def negative(self, found: Value) -> tuple[str, int]:
        return f"dual_negative({found.text})", ATOM

    def combined(self, sign: str, left: Value, right: Value) -> tuple[str, int]:
        return f"dual_{WORDS[sign]}({left.text}, {right.text})", ATOM
