"""One function of the physics as C."""

from __future__ import annotations

import ast
import dataclasses
from dataclasses import dataclass
from types import FunctionType
from typing import TYPE_CHECKING, Any

from .calls import Parameter, Signature
from .context import Context
from .kinds import Kind, View, kind_of, structured
from .names import OWN
from .scope import assigned_in, read_in, scopes, stored_in
from .source import Source
from .statements import Statements
from .text import STEP, comment, wrapped

if TYPE_CHECKING:
    from .unit import Unit


@dataclass(frozen=True)
class Function:
    """A translated function: what a call needs, its head without a storage class, its text."""

    signature: Signature
    comment: list[str]
    head: str
    text: list[str]


def translated(
    unit: Unit, source: Source, function: FunctionType, name: str, *, entry: bool
) -> Function:
    """Translate a function; an `entry` can be called from other files, with a `Fault` always."""
    node = source.functions.get(function.__name__)
    if node is None:
        source.refuse(1, f"{function.__name__}() is not a function of this file")
    if node.decorator_list:
        source.refuse(node, f"{node.name}(): decorators are outside the subset")
    parameters = _parameters(unit, source, node, function)
    returns = _annotated(unit, source, node, node.returns, f"{node.name}() returns")
    context, going = _body(unit, source, node, parameters, returns)
    if going:
        source.refuse(node.body[-1], f"{node.name}() may end without a return")
    causes = frozenset(context.made.causes)
    signature = Signature(name, tuple(parameters), returns, causes, entry or bool(causes))
    head = _head(unit, context, signature)
    unused = [context.named(p.name) for p in parameters if p.name not in context.read]
    if entry and not causes:
        unused.insert(0, "fault")
    lines = wrapped(head if entry else f"{unit.arithmetic.storage} {head}", "")
    lines.append("{")
    if unused:
        lines += wrapped(", ".join(f"(void){name}" for name in unused) + ";", STEP)
    return Function(
        signature, comment(ast.get_docstring(node) or ""), head, [*lines, *context.made.lines, "}"]
    )


def _body(
    unit: Unit, source: Source, node: ast.FunctionDef, parameters: list[Parameter], returns: Kind
) -> tuple[Context, bool]:
    """Translate until types and names are sure: a later line may tell of an earlier one's."""
    kinds: dict[str, Kind] = {}
    taken = OWN
    where = scopes(node)
    while True:
        context = Context(unit, source, stored_in(node), read_in(node), kinds, taken)
        context.parameters = frozenset(p.name for p in parameters)
        for p in parameters:
            context.kinds[p.name] = p.kind
            context.bound.add(p.name)
            context.places[p.name] = "pointer" if p.by_address else "variable"
        going = Statements(context, where, returns).block(node.body)
        hidden = context.globals & {context.named(name) for name in context.stored}
        if not context.unsure and not hidden:
            return context, going
        kinds = context.kinds
        taken = taken | hidden


def _parameters(
    unit: Unit, source: Source, node: ast.FunctionDef, function: FunctionType
) -> list[Parameter]:
    """The parameters with their types and defaults."""
    a = node.args
    if a.vararg or a.kwarg or a.kwonlyargs or a.posonlyargs:
        source.refuse(node, f"{node.name}(): plain parameters only")
    changed = assigned_in(node.body)
    defaults: tuple[Any, ...] = function.__defaults__ or ()
    missing = [dataclasses.MISSING] * (len(a.args) - len(defaults))
    made = []
    for argument, default in zip(a.args, [*missing, *defaults], strict=True):
        what = f"{node.name}(): parameter {argument.arg} is"
        kind = _annotated(unit, source, argument, argument.annotation, what)
        by_address = structured(kind) and argument.arg not in changed
        made.append(Parameter(argument.arg, kind, by_address, default))
    return made


def _annotated(
    unit: Unit, source: Source, place: ast.AST, annotation: ast.expr | None, what: str
) -> Kind:
    """The type that an annotation names."""
    if annotation is None:
        source.refuse(place, f"{what} not annotated")
    text = ast.unparse(annotation)
    try:
        found = eval(text, dict(vars(source.module)))
    except (NameError, AttributeError, TypeError, SyntaxError) as error:
        source.refuse(annotation, f"{what} {text}: {error}")
    kind = kind_of(found)
    if kind is None or (isinstance(kind, View) and what.endswith("returns")):
        source.refuse(annotation, f"{what} {text}, which is outside the subset")
    unit.known_as(kind, text if isinstance(annotation, ast.Name) else "", source)
    return kind


def _head(unit: Unit, context: Context, signature: Signature) -> str:
    """Declaration of a function without its storage class."""
    given = ["Fault *fault"] if signature.fallible else []
    for p in signature.parameters:
        name = context.named(p.name)
        kind = unit.c_type(p.kind)
        given.append(f"const {kind} *{name}" if p.by_address else f"{kind} {name}")
    return f"{unit.c_type(signature.returns)} {signature.name}({', '.join(given) or 'void'})"
