"""Calls of the subset as C: of `math`, of Python's own functions, of physics, of records."""

from __future__ import annotations

import ast
import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType
from typing import Any

from . import expressions, subset
from .context import Context
from .kinds import FLOAT, NUMBERS, ROUNDED, WHOLE, Kind, Record, structured
from .value import ATOM, NOTHING, UNARY, Value


@dataclass(frozen=True)
class Parameter:
    """A parameter of a translated function; structs go by their address if they are not changed."""

    name: str
    kind: Kind
    by_address: bool
    default: Any = dataclasses.MISSING


@dataclass(frozen=True)
class Signature:
    """What a call of a translated function needs."""

    name: str
    parameters: tuple[Parameter, ...]
    returns: Kind
    causes: frozenset[str]
    fallible: bool


def call(c: Context, node: ast.Call) -> Value:
    """C of a call."""
    if any(isinstance(a, ast.Starred) for a in node.args) or any(
        k.arg is None for k in node.keywords
    ):
        c.refuse(node, "arguments with stars are outside the subset")
    shown = ast.unparse(node.func)
    function = node.func
    if isinstance(function, ast.Attribute):
        module = expressions.module_of(c, function.value)
        if module is math:
            return _mathematics(c, node, function.attr)
        if module is None:
            owner = function.value
            if isinstance(owner, ast.Name) and expressions.is_unknown(c, owner.id):
                c.refuse(node, expressions.unknown(owner.id))
            c.refuse(node, f"{shown}() is outside the subset")
        source, name = c.unit.source(c, node, module), function.attr
    elif isinstance(function, ast.Name) and expressions.is_unknown(c, function.id):
        c.refuse(node, expressions.unknown(function.id))
    elif isinstance(function, ast.Name) and function.id not in c.stored:
        source, name = c.source, function.id
    else:
        c.refuse(node, f"{shown}() is outside the subset")
    found = vars(source.module).get(name)
    if found is None and source is c.source and name in subset.BUILTINS:
        return _BUILTINS[name](c, node)
    if isinstance(found, FunctionType):
        return _physics(c, node, c.unit.function(c, node, found))
    if not isinstance(found, type) or not dataclasses.is_dataclass(found):
        c.refuse(node, f"{shown}() is outside the subset")
    return _record(c, node, Record(found))


def _mathematics(c: Context, node: ast.Call, name: str) -> Value:
    """A function of `math`."""
    if name not in subset.ARGUMENTS:
        c.refuse(node, f"math.{name} is outside the subset")
    count = subset.ARGUMENTS[name]
    if len(node.args) != count or node.keywords:
        c.refuse(node, f"math.{name} takes {count} argument{'s'[: count - 1]} here")
    parts = c.ordered([_number(c, argument) for argument in node.args])
    causes = frozenset().union(*(part.causes for part in parts))
    given = ", ".join(part.text for part in parts)
    named = c.unit.arithmetic.function
    if name in ("fabs", "copysign"):
        return Value(f"{c.shared(named(name))}({given})", FLOAT, ATOM, causes)
    if name in subset.PLAIN:
        return Value(f"{named(f'{name}_of')}({given})", FLOAT, ATOM, causes)
    own = {"DOMAIN_ERROR"}
    if name in subset.GROWING:
        own = {"RANGE_ERROR"}
    elif name == "pow":
        own = {"DOMAIN_ERROR", "RANGE_ERROR"}
    elif name in subset.ROUNDING:
        own = {"INFINITE_TO_WHOLE", "NAN_TO_WHOLE"}
    kind = ROUNDED if name in subset.ROUNDING else FLOAT
    raised = causes | c.raising(frozenset(own))
    return Value(f"{named(f'{name}_of')}(fault, {given})", kind, ATOM, raised)


def _number(c: Context, node: ast.expr) -> Callable[[], Value]:
    return lambda: expressions.number(c, node)


def _extreme(c: Context, node: ast.Call, name: str) -> Value:
    """`min` or `max` of two or more."""
    if len(node.args) < 2 or node.keywords:
        c.refuse(node, "min() and max() take two arguments or more here, without names")
    parts = c.ordered([_valued(c, argument) for argument in node.args])
    causes = NOTHING.union(*(part.causes for part in parts))
    kinds = {part.kind for part in parts}
    kind: Kind = ROUNDED if ROUNDED in kinds else FLOAT
    if kinds == {WHOLE}:
        name, kind = f"whole_{name}", WHOLE
    elif not kinds <= {*NUMBERS}:
        odd = next(part.kind for part in parts if part.kind not in NUMBERS)
        c.refuse(node, f"{odd.name} in `{ast.unparse(node)}`: floats only, or ints only")
    else:
        name = c.unit.arithmetic.function(name)
    text = parts[0].text
    for part in parts[1:]:
        text = f"{name}({text}, {part.text})"
    return Value(text, kind, ATOM, causes)


def _valued(c: Context, node: ast.expr) -> Callable[[], Value]:
    return lambda: expressions.value(c, node)


def _alone(c: Context, node: ast.Call, name: str) -> Value:
    """The one argument of `int` or `float`, a number."""
    if len(node.args) != 1 or node.keywords:
        c.refuse(node, f"{name}() takes one argument here")
    found = expressions.value(c, node.args[0])
    if found.kind not in (*NUMBERS, WHOLE):
        c.refuse(node, f"{name}() of {found.kind.name}")
    return found


def _integer(c: Context, node: ast.Call) -> Value:
    found = _alone(c, node, "int")
    if found.kind == WHOLE:
        return found
    if found.constant is not None and math.fabs(found.constant) < expressions.LARGEST:
        if isinstance(node.args[0], ast.Constant):
            return expressions.constant_of(c, node, int(found.constant))
        text = f"(int64_t){c.unit.arithmetic.value(found, ATOM)}"
        return Value(text, WHOLE, UNARY, found.causes, int(found.constant), simple=True)
    own = c.raising(frozenset({"INFINITE_TO_WHOLE", "NAN_TO_WHOLE"}))
    text = f"whole_of(fault, {c.unit.arithmetic.value(found)})"
    return Value(text, WHOLE, ATOM, found.causes | own)


def _float(c: Context, node: ast.Call) -> Value:
    found = _alone(c, node, "float")
    if found.kind != WHOLE:
        return dataclasses.replace(found, kind=FLOAT)
    return expressions.as_float(c, found)


_BUILTINS: dict[str, Callable[[Context, ast.Call], Value]] = {
    "min": lambda c, node: _extreme(c, node, "smaller"),
    "max": lambda c, node: _extreme(c, node, "larger"),
    "int": _integer,
    "float": _float,
}


def _physics(c: Context, node: ast.Call, signature: Signature) -> Value:
    """A function of the physics; omitted arguments take their defaults."""
    shown = ast.unparse(node.func)
    places = {parameter.name: k for k, parameter in enumerate(signature.parameters)}
    if len(node.args) > len(places):
        c.refuse(node, f"{shown}() takes {len(places)} arguments")
    given: list[tuple[int, ast.expr]] = list(enumerate(node.args))
    for keyword in node.keywords:
        if keyword.arg not in places or places[keyword.arg] in dict(given):
            c.refuse(node, f"{shown}(): argument {keyword.arg}")
        given.append((places[keyword.arg], keyword.value))
    parts = c.ordered([_argument(c, signature.parameters[k], value) for k, value in given])
    values = {k: part for (k, _), part in zip(given, parts, strict=True)}
    for k, parameter in enumerate(signature.parameters):
        if k in values:
            continue
        if parameter.default is dataclasses.MISSING:
            c.refuse(node, f"{shown}(): no argument {parameter.name}")
        values[k] = expressions.constant_of(c, node, parameter.default)
    passed = [_passed(c, values[k], parameter) for k, parameter in enumerate(signature.parameters)]
    if signature.fallible:
        passed.insert(0, "fault")
    causes = c.raising(signature.causes)
    causes = causes.union(*(part.causes for part in parts))
    text = f"{c.shared(signature.name)}({', '.join(passed)})"
    return Value(text, signature.returns, ATOM, causes)


def _argument(c: Context, parameter: Parameter, node: ast.expr) -> Callable[[], Value]:
    what = f"argument {parameter.name} (`{ast.unparse(node)}`)"
    return lambda: expressions.of_kind(c, node, parameter.kind, what)


def _passed(c: Context, value: Value, parameter: Parameter) -> str:
    """Text of an argument: a struct by its address, a passing one in an array of one."""
    if not structured(value.kind) or not parameter.by_address:
        return value.plain
    if value.place == "pointer":
        return value.text
    if value.place == "variable":
        return f"&{value.text}"
    name = c.shared(c.unit.c_type(value.kind))
    if value.text.startswith(f"({name}){{"):
        return f"&{value.text}"
    return f"({name}[1]){{{value.text}}}"


def _record(c: Context, node: ast.Call, kind: Record) -> Value:
    """A record made of all its fields by name."""
    fields = c.unit.fields(kind)
    named = [keyword.arg or "" for keyword in node.keywords]
    if node.args or sorted(named) != sorted(fields):
        c.refuse(node, f"{kind.source.__name__}: give all fields by name, and nothing else")
    parts = c.ordered([_field(c, fields[k.arg or ""], k.arg or "", k.value) for k in node.keywords])
    texts = [
        f".{c.unit.field_name(name)} = {part.plain}"
        for name, part in zip(named, parts, strict=True)
    ]
    causes = NOTHING.union(*(part.causes for part in parts))
    if not texts:
        texts = ["0"]
    return Value(f"({c.shared(c.unit.c_type(kind))}){{{', '.join(texts)}}}", kind, ATOM, causes)


def _field(c: Context, kind: Kind, name: str, node: ast.expr) -> Callable[[], Value]:
    return lambda: expressions.of_kind(c, node, kind, f"field {name} (`{ast.unparse(node)}`)")
