"""The function that is being translated: its variables so far, and the C lines made of it."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NoReturn

from .kinds import FLOAT, NUMBERS, ROUNDED, Kind, View, structured
from .names import local
from .source import Source
from .text import STEP, wrapped
from .value import ATOM, NOTHING, Value, viewed

if TYPE_CHECKING:
    from .unit import Unit


@dataclass
class Made:
    """Lines that were made apart, and the errors that they raise."""

    lines: list[str] = field(default_factory=list)
    causes: set[str] = field(default_factory=set)


class Context:
    """What expressions and statements of one function have in common.

    `stored` and `read` name the variables that are assigned and read anywhere in it; `bound` those
    that have a value at this point; `kinds` their types, which an earlier pass may have widened.
    """

    def __init__(
        self,
        unit: Unit,
        source: Source,
        stored: frozenset[str],
        read: frozenset[str],
        kinds: dict[str, Kind],
        used: frozenset[str],
    ) -> None:
        self.unit = unit
        self.source = source
        self.stored = stored
        self.read = read
        self.kinds = dict(kinds)
        self.unsure = False
        self.bound: set[str] = set()
        self.places: dict[str, str] = {}
        self.parameters: frozenset[str] = frozenset()
        self.loops: dict[str, int | None] = {}
        self.globals: set[str] = set()
        self.made = Made()
        self.indent = STEP
        self._taken = used
        self._kept = 0

    def refuse(self, node: ast.AST, text: str) -> NoReturn:
        """Raise :class:`NativeError` with file and line."""
        self.source.refuse(node, text)

    def emit(self, text: str) -> None:
        """Add a statement."""
        self.made.lines += wrapped(text, self.indent)

    @contextmanager
    def apart(self, *, deeper: bool = False) -> Iterator[Made]:
        """Collect lines instead of adding them; their errors still count for the whole."""
        outer, self.made = self.made, Made()
        indent = self.indent
        if deeper:
            self.indent += STEP
        try:
            yield self.made
        finally:
            outer.causes |= self.made.causes
            self.made = outer
            self.indent = indent

    def raising(self, causes: frozenset[str]) -> frozenset[str]:
        """Note errors that an expression raises; returns them."""
        self.made.causes |= causes
        return causes

    def named(self, name: str) -> str:
        """C name of a variable."""
        return local(name, self._taken)

    def shared(self, name: str) -> str:
        """Note the use of a name of the file, which no variable may then hide."""
        self.globals.add(name)
        return name

    def fresh(self) -> str:
        """Name of a variable that the source does not have."""
        self._kept += 1
        name = self.named(f"kept{self._kept}")
        while name in self.stored:
            name += "_"
        return name

    def kept(self, value: Value) -> Value:
        """The value held in a constant of its own, worked out here."""
        value = viewed(value)
        name = self.fresh()
        self.emit(f"const {self.unit.c_type(value.kind)} {name} = {value.plain};")
        place = "variable" if structured(value.kind) else "value"
        return Value(name, value.kind, ATOM, NOTHING, value.constant, place, simple=True)

    def ordered(
        self, parts: Sequence[Callable[[], Value]], keep: frozenset[int] = frozenset()
    ) -> list[Value]:
        """Values worked out from left to right, as Python does and C need not.

        The order tells where two of them may raise different errors: the earlier one is then
        kept. So are those whose number is in `keep`, which are used twice, if they may fail.
        """
        found = []
        for part in parts:
            with self.apart() as made:
                value = part()
            found.append((value, made))
        values = []
        for number, (value, made) in enumerate(found):
            self.made.lines += made.lines
            later: set[str] = set().union(*(after.causes for _, after in found[number + 1 :]))
            early = bool(value.causes and later and len(value.causes | later) > 1)
            if early or (number in keep and value.causes):
                value = self.kept(value)
            values.append(value)
        return values

    def assigned(self, node: ast.AST, name: str, kind: Kind) -> Kind:
        """Note that a variable takes a value of a type; returns the type that the variable has."""
        before = self.kinds.get(name)
        self.bound.add(name)
        if before is None:
            if isinstance(kind, View) and kind.dimensions > 2:
                self.refuse(node, f"{name}: index the table down to two dimensions first")
            self.kinds[name] = kind
            return kind
        if before == kind:
            return before
        if before not in NUMBERS or kind not in NUMBERS:
            self.refuse(node, f"{name} is {before.name} before, and {kind.name} here")
        if before == FLOAT:
            self.kinds[name] = ROUNDED
            self.unsure = True
        return ROUNDED
