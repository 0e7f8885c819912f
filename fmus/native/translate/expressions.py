"""Expressions of the subset as C."""

from __future__ import annotations

import ast
import builtins
import dataclasses
import math
import operator
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

from . import calls, subset
from .arithmetic import Plain
from .context import Context
from .kinds import FLOAT, NUMBERS, ROUNDED, TRUTH, WHOLE, Fixed, Kind, Record, Table, View
from .text import literal
from .value import AND, ATOM, CHOICE, EQUAL, ORDER, UNARY, Value, viewed

FOLDED: dict[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
LARGEST = 2**62


def value(c: Context, node: ast.expr) -> Value:
    """C of an expression; :class:`NativeError` where the subset does not have it."""
    handler = _HANDLERS.get(type(node))
    if handler is None:
        c.refuse(node, f"`{_shown(node)}` is outside the subset")
    return handler(c, node)


def number(c: Context, node: ast.expr) -> Value:
    """An expression that has to be a float."""
    found = value(c, node)
    if found.kind not in NUMBERS:
        c.refuse(node, f"`{_shown(node)}` is {found.kind.name}; a float is needed: write float()")
    return found


def truth(c: Context, node: ast.expr) -> Value:
    """An expression that has to be true or false."""
    found = value(c, node)
    if found.kind != TRUTH:
        c.refuse(node, f"`{_shown(node)}` is {found.kind.name}: write the comparison that is meant")
    return found


def of_kind(c: Context, node: ast.expr, kind: Kind, what: str) -> Value:
    """An expression of a type, as it is passed on or kept: a table as a view."""
    found = viewed(value(c, node))
    if found.kind != kind:
        way = ": write float()" if found.kind in (ROUNDED, WHOLE) and kind == FLOAT else ""
        c.refuse(node, f"{what} is {found.kind.name}, and {kind.name} is needed{way}")
    return found


def constant_of(c: Context, node: ast.expr, given: Any) -> Value:
    """C of a number or a truth value that is known."""
    if isinstance(given, bool):
        return Value("true" if given else "false", TRUTH, constant=given, simple=True)
    if isinstance(given, int):
        if abs(given) >= LARGEST:
            c.refuse(node, f"{given} has more than 62 bits")
        return Value(str(given), WHOLE, constant=given, simple=True)
    if not isinstance(given, float):
        c.refuse(node, f"`{_shown(node)}` is neither a number nor a truth value")
    text, rank = c.unit.arithmetic.constant(literal(given))
    return Value(text, FLOAT, rank, constant=given, simple=True)


def _shown(node: ast.AST) -> str:
    """The source of a node, cut short."""
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


def _constant(c: Context, node: ast.Constant) -> Value:
    return constant_of(c, node, node.value)


def _name(c: Context, node: ast.Name) -> Value:
    name = node.id
    if name in c.stored:
        if name not in c.bound:
            c.refuse(node, f"{name} may have no value here")
        kind = c.kinds[name]
        place = c.places.get(name, "variable")
        return Value(c.named(name), kind, place=place, simple=True, below=c.loops.get(name))
    if name not in vars(c.source.module):
        c.refuse(node, unknown(name))
    return c.unit.global_value(c, node, c.source, name)


def _attribute(c: Context, node: ast.Attribute) -> Value:
    module = module_of(c, node.value)
    if module is math:
        if node.attr not in subset.CONSTANTS:
            c.refuse(node, f"math.{node.attr} is outside the subset")
        known = constant_of(c, node, getattr(math, node.attr))
        text, rank = c.unit.arithmetic.constant(c.shared(node.attr.upper()))
        return dataclasses.replace(known, text=text, rank=rank)
    if module is not None:
        return c.unit.global_value(c, node, c.unit.source(c, node, module), node.attr)
    owner = value(c, node.value)
    if not isinstance(owner.kind, Record):
        c.refuse(node, f"`{_shown(node)}`: {owner.kind.name} has no fields")
    fields = c.unit.fields(owner.kind)
    if node.attr not in fields:
        c.refuse(node, f"{owner.kind.name} has no field {node.attr}")
    inner = fields[node.attr]
    return Value(
        owner.member(c.unit.field_name(node.attr)),
        inner,
        ATOM,
        owner.causes,
        place="variable" if owner.place != "value" else "value",
        simple=owner.simple,
    )


def unknown(name: str) -> str:
    """What a refusal says of a name that the module does not have, and the way out."""
    if name in dir(math):
        return f"{name} is not known; write math.{name}, with import math at the head of the file"
    if name in sys.stdlib_module_names:
        return f"{name} is not imported; write import {name} at the head of the file"
    return f"{name} is not known; define or import it"


def is_unknown(c: Context, name: str) -> bool:
    """Whether a name is neither a variable, nor in the module, nor Python's own."""
    return not (name in c.stored or name in vars(c.source.module) or name in dir(builtins))


def module_of(c: Context, node: ast.expr) -> ModuleType | None:
    """The module that a name stands for, if it stands for one."""
    if isinstance(node, ast.Name) and node.id not in c.stored:
        found = vars(c.source.module).get(node.id)
        return found if isinstance(found, ModuleType) else None
    return None


def _unary(c: Context, node: ast.UnaryOp) -> Value:
    if isinstance(node.op, ast.Not):
        inner = truth(c, node.operand)
        return Value(f"!{inner.within(UNARY)}", TRUTH, UNARY, inner.causes)
    if not isinstance(node.op, ast.USub | ast.UAdd):
        c.refuse(node, f"`{_shown(node)}` is outside the subset")
    inner = value(c, node.operand)
    if inner.kind == ROUNDED:
        c.refuse(node, "floor() and ceil() give an int, whose -0 is 0: write float() around it")
    if inner.kind not in (FLOAT, WHOLE):
        c.refuse(node, f"`{_shown(node)}`: the sign of {inner.kind.name}")
    if isinstance(node.op, ast.UAdd):
        return inner
    text, rank = _arithmetic(c, inner.kind).negative(inner)
    known = None if inner.constant is None else -inner.constant
    return Value(text, inner.kind, rank, inner.causes, known, simple=known is not None)


def _binary(c: Context, node: ast.BinOp) -> Value:
    sign = subset.OPERATORS.get(type(node.op))
    if sign is None:
        c.refuse(node, f"`{_shown(node)}` is outside the subset; for a power write products")
    left, right = c.ordered([lambda: value(c, node.left), lambda: value(c, node.right)])
    kinds = (left.kind, right.kind)
    if kinds == (WHOLE, WHOLE) and sign != "/":
        return _combined(c, sign, left, right, WHOLE)
    if kinds[0] == kinds[1] == WHOLE:
        c.refuse(node, f"`{_shown(node)}` divides two ints: write float() around one, or //")
    left = _beside(c, node, node.left, left)
    right = _beside(c, node, node.right, right)
    if kinds == (ROUNDED, ROUNDED):
        c.refuse(node, f"both sides of `{_shown(node)}` are ints: write float() around one")
    return _combined(c, sign, left, right, FLOAT)


def _beside(c: Context, node: ast.BinOp, part: ast.expr, found: Value) -> Value:
    """An operand beside a float: an int becomes one, unless it is written as a number."""
    if found.kind == WHOLE and isinstance(part, ast.Constant):
        c.refuse(node, f"{found.text} beside a float in `{_shown(node)}`: write {found.text}.0")
    if found.kind == WHOLE:
        return as_float(c, found)
    if found.kind not in NUMBERS:
        c.refuse(node, f"`{_shown(part)}` is {found.kind.name} in `{_shown(node)}`")
    return found


def as_float(c: Context, found: Value) -> Value:
    """An int as a float."""
    known = None if found.constant is None else float(found.constant)
    text = f"(double){found.within(ATOM)}" if known is None or not found.text.isdigit() else ""
    text, rank = c.unit.arithmetic.constant(text or literal(float(known or 0.0)))
    return Value(text, FLOAT, rank, found.causes, known)


def _arithmetic(c: Context, kind: Kind) -> Plain:
    """How numbers of a type are written: an int always as a plain one."""
    return Plain() if kind == WHOLE else c.unit.arithmetic


def _combined(c: Context, sign: str, left: Value, right: Value, kind: Kind) -> Value:
    """Two operands of one type under a sign."""
    causes = left.causes | right.causes
    if sign in ("//", "%"):
        pairs = {"//": ("floored_of", "ZERO_FLOOR"), "%": ("remainder_of", "ZERO_MODULO")}
        wholes = {
            "//": ("whole_floored", "ZERO_WHOLE_FLOOR"),
            "%": ("whole_remainder", "ZERO_WHOLE_MODULO"),
        }
        function, cause = (wholes if kind == WHOLE else pairs)[sign]
        function = _arithmetic(c, kind).function(function)
        own = c.raising(frozenset({cause}))
        return Value(f"{function}(fault, {left.text}, {right.text})", kind, ATOM, causes | own)
    if sign == "/" and not right.constant:
        own = c.raising(frozenset({"ZERO_DIVISION"}))
        function = c.unit.arithmetic.function("quotient")
        return Value(f"{function}(fault, {left.text}, {right.text})", kind, ATOM, causes | own)
    known = None
    if left.constant is not None and right.constant is not None:
        known = FOLDED[sign](left.constant, right.constant)
    text, rank = _arithmetic(c, kind).combined(sign, left, right)
    return Value(text, kind, rank, causes, known)


def _compare(c: Context, node: ast.Compare) -> Value:
    operands = [node.left, *node.comparators]
    signs = []
    for op in node.ops:
        if type(op) not in subset.COMPARISONS:
            c.refuse(node, f"`{_shown(node)}`: this comparison is outside the subset")
        signs.append(subset.COMPARISONS[type(op)])
    first, second = c.ordered(
        [lambda: value(c, operands[0]), lambda: value(c, operands[1])],
        keep=frozenset({1} if len(signs) > 1 else ()),
    )
    found = _compared(c, node, signs[0], first, second)
    for number_, sign in enumerate(signs[1:], start=2):
        last = number_ == len(signs)
        with c.apart(deeper=True) as made:
            following = value(c, operands[number_])
            if not last and following.causes:
                following = c.kept(following)
            step = _compared(c, node, sign, second, following)
        if made.lines and not last:
            c.refuse(node, f"`{_shown(node)}`: split this comparison with `and`")
        found = _joined(c, found, "&&", step, made.lines)
        second = following
    return found


def _compared(c: Context, node: ast.expr, sign: str, left: Value, right: Value) -> Value:
    alike = (left.kind in NUMBERS and right.kind in NUMBERS) or left.kind == right.kind == WHOLE
    if not alike:
        c.refuse(node, f"`{_shown(node)}` compares {left.kind.name} with {right.kind.name}")
    rank = EQUAL if sign in ("==", "!=") else ORDER
    plain = _arithmetic(c, left.kind)
    text = f"{plain.value(left, rank - 1)} {sign} {plain.value(right, rank - 1)}"
    return Value(text, TRUTH, rank, left.causes | right.causes)


def _boolean(c: Context, node: ast.BoolOp) -> Value:
    sign = "&&" if isinstance(node.op, ast.And) else "||"
    found = truth(c, node.values[0])
    for part in node.values[1:]:
        with c.apart(deeper=True) as made:
            following = truth(c, part)
        found = _joined(c, found, sign, following, made.lines)
    return found


def _joined(c: Context, left: Value, sign: str, right: Value, before: list[str]) -> Value:
    """`left and right`, or `or`; `before` is what `right` needs done first."""
    if before:
        return _decided(c, left, sign, right, before)
    rank = AND if sign == "&&" else AND + 1
    text = f"{_operand(left, sign)} {sign} {_operand(right, sign)}"
    return Value(text, TRUTH, rank, left.causes | right.causes)


def _operand(part: Value, sign: str) -> str:
    """One side of `&&` or `||`; a chain of the same sign needs no brackets."""
    chained = part.rank == (AND if sign == "&&" else AND + 1)
    return part.text if chained else part.within(EQUAL)


def _decided(c: Context, left: Value, sign: str, right: Value, before: list[str]) -> Value:
    """The same by an `if`, since the right side needs statements."""
    name = c.fresh()
    c.emit(f"bool {name} = {left.text};")
    c.emit(f"if ({name if sign == '&&' else f'!{name}'}) {{")
    c.made.lines += [*before, f"{c.indent}    {name} = {right.text};"]
    c.emit("}")
    return Value(name, TRUTH, simple=True)


def _choice(c: Context, node: ast.IfExp) -> Value:
    test = truth(c, node.test)
    sides = []
    for part in (node.body, node.orelse):
        with c.apart(deeper=True) as made:
            sides.append((viewed(value(c, part)), made.lines))
    (yes, before_yes), (no, before_no) = sides
    if yes.kind != no.kind:
        c.refuse(node, f"`{_shown(node)}` is {yes.kind.name} or {no.kind.name}")
    if not before_yes and not before_no:
        text = f"{test.within(AND + 1)} ? {_plain(yes)} : {_plain(no)}"
        causes = test.causes | yes.causes | no.causes
        return Value(text, yes.kind, CHOICE, causes)
    name = c.fresh()
    c.emit(f"{c.unit.c_type(yes.kind)} {name};")
    c.emit(f"if ({test.text}) {{")
    c.made.lines += [*before_yes, f"{c.indent}    {name} = {yes.plain};"]
    c.emit("} else {")
    c.made.lines += [*before_no, f"{c.indent}    {name} = {no.plain};"]
    c.emit("}")
    return Value(name, yes.kind, place="variable", simple=True)


def _plain(found: Value) -> str:
    """A side of a choice."""
    return found.plain if found.rank <= CHOICE - 1 else f"({found.plain})"


def _tuple(c: Context, node: ast.Tuple) -> Value:
    parts = c.ordered([_entry(c, part) for part in node.elts])
    kind = Fixed(tuple(part.kind for part in parts))
    if not parts:
        c.refuse(node, "an empty tuple is outside the subset")
    causes = frozenset().union(*(part.causes for part in parts))
    inner = ", ".join(part.plain for part in parts)
    inner = f"{{{inner}}}" if kind.uniform else inner
    return Value(f"({c.shared(c.unit.c_type(kind))}){{{inner}}}", kind, ATOM, causes)


def _entry(c: Context, node: ast.expr) -> Callable[[], Value]:
    def found() -> Value:
        entry = value(c, node)
        if entry.kind == ROUNDED or isinstance(entry.kind, View | Table):
            c.refuse(node, f"{entry.kind.name} in a tuple: write float(), or index the table")
        return entry

    return found


def _subscript(c: Context, node: ast.Subscript) -> Value:
    owner, index = c.ordered([lambda: value(c, node.value), lambda: value(c, node.slice)])
    if index.kind != WHOLE:
        c.refuse(node, f"the index of `{_shown(node)}` is {index.kind.name}; an int is needed")
    causes = owner.causes | index.causes
    if isinstance(owner.kind, View):
        own = c.raising(frozenset({"OUT_OF_RANGE"}))
        if owner.kind.dimensions == 2:
            text = f"row_of(fault, {owner.text}, {index.text})"
            return Value(text, View(1), ATOM, causes | own)
        entry_ = f"entry_of(fault, {owner.text}, {index.text})"
        text, rank = c.unit.arithmetic.constant(entry_)
        return Value(text, FLOAT, rank, causes | own)
    if isinstance(owner.kind, Table):
        place, own = _within(c, node, index, owner.kind.shape[0])
        rest = owner.kind.shape[1:]
        text = f"{owner.text}[{place}]"
        if rest:
            return Value(text, Table(rest), ATOM, causes | own)
        text, rank = c.unit.arithmetic.constant(text)
        return Value(text, FLOAT, rank, causes | own)
    if not isinstance(owner.kind, Fixed):
        c.refuse(node, f"`{_shown(node)}`: {owner.kind.name} has no entries")
    place, own = _within(c, node, index, len(owner.kind.entries))
    if not owner.kind.uniform and index.constant is None:
        c.refuse(node, f"the index of `{_shown(node)}` must be written as a number")
    if owner.place == "value":
        owner = c.kept(owner)
        causes = index.causes
    number_ = int(place) if index.constant is not None else 0
    return entry(c, owner, number_, place, causes | own)


def entry(c: Context, owner: Value, number_: int, place: str, causes: frozenset[str]) -> Value:
    """An entry of a tuple that has an address."""
    assert isinstance(owner.kind, Fixed)
    member = f"at[{place}]" if owner.kind.uniform else f"item{number_}"
    return Value(owner.member(member), owner.kind.entries[number_], ATOM, causes, place="variable")


def _within(
    c: Context, node: ast.Subscript, index: Value, length: int
) -> tuple[str, frozenset[str]]:
    """Text of an index that is held within a length."""
    if index.constant is not None:
        given = int(index.constant)
        if not -length <= given < length:
            c.refuse(node, f"index {given} of `{_shown(node)}` is beyond {length} entries")
        return str(given % length), frozenset()
    if index.below is not None and index.below <= length:
        return index.text, frozenset()
    own = c.raising(frozenset({"OUT_OF_RANGE"}))
    return f"within(fault, {index.text}, {length})", own


def _call(c: Context, node: ast.Call) -> Value:
    return calls.call(c, node)


_HANDLERS: dict[type[ast.expr], Callable[[Context, Any], Value]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.UnaryOp: _unary,
    ast.BinOp: _binary,
    ast.Compare: _compare,
    ast.BoolOp: _boolean,
    ast.IfExp: _choice,
    ast.Tuple: _tuple,
    ast.Subscript: _subscript,
    ast.Call: _call,
}
