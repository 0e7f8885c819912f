"""Statements of the subset as C, block by block."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from . import expressions
from .context import Context
from .kinds import FLOAT, WHOLE, Fixed, Kind
from .scope import Block, Scope, assigned_in
from .text import STEP, flat, quoted
from .value import NOTHING, UNARY, Value, viewed


class Statements:
    """The body of one function; `returns` is what it gives back."""

    def __init__(self, context: Context, scopes: dict[str, Scope], returns: Kind) -> None:
        self._c = context
        self._scopes = scopes
        self._returns = returns
        self._declared: set[str] = set()

    def block(self, body: list[ast.stmt], block: Block = ()) -> bool:
        """Translate statements; whether the end of them can be reached."""
        going = True
        for number, node in enumerate(body):
            if not going:
                break
            self._declare(block, number, node)
            handler = _HANDLERS.get(type(node))
            if handler is None:
                text = flat(ast.unparse(node)).split(":")[0]
                self._c.refuse(node, f"`{text[:60]}` is outside the subset")
            going = handler(self, node, (*block, (number, "")))
        return going

    def _declare(self, block: Block, number: int, node: ast.stmt) -> None:
        """Declare what is first used by a statement of this block but not assigned by it alone."""
        own = _targets(node)
        for name, scope in self._scopes.items():
            if scope.block != block or scope.first != number or name in own:
                continue
            if name in self._c.read:
                kind = self._c.kinds.get(name, FLOAT)
                self._c.unsure |= name not in self._c.kinds
                self._c.emit(f"{self._c.unit.c_type(kind)} {self._c.named(name)};")
            self._declared.add(name)

    def _put(self, node: ast.stmt, name: str, value: Value) -> None:
        """Assign to a variable, and declare it where it lives from here on."""
        c = self._c
        if name not in c.read:
            if not name.startswith("_"):
                c.assigned(node, name, value.kind)
            if value.causes:
                c.emit(f"(void){value.within(UNARY)};")
            return
        scope = self._scopes.get(name)
        if scope is None and name not in c.parameters:
            c.refuse(node, f"{name} is the variable of a loop: give this another name")
        kind = c.assigned(node, name, value.kind)
        head = ""
        if scope is not None and name not in self._declared:
            head = f"{'const ' if scope.once else ''}{c.unit.c_type(kind)} "
            self._declared.add(name)
        c.emit(f"{head}{c.named(name)} = {value.plain};")

    def assign(self, node: ast.Assign, _: Block) -> bool:
        if len(node.targets) != 1:
            self._c.refuse(node, "one variable at a time")
        return self._assign(node, node.targets[0], node.value)

    def annotated(self, node: ast.AnnAssign, _: Block) -> bool:
        if node.value is None:
            self._c.refuse(node, "a variable needs a value")
        return self._assign(node, node.target, node.value)

    def _assign(self, node: ast.stmt, target: ast.expr, value: ast.expr) -> bool:
        c = self._c
        if isinstance(target, ast.Name):
            self._put(node, target.id, viewed(expressions.value(c, value)))
        elif isinstance(target, ast.Tuple) and all(isinstance(e, ast.Name) for e in target.elts):
            self._unpack(node, [e.id for e in target.elts if isinstance(e, ast.Name)], value)
        else:
            c.refuse(node, "only variables can be assigned to")
        return True

    def _unpack(self, node: ast.stmt, names: list[str], value: ast.expr) -> None:
        c = self._c
        if isinstance(value, ast.Tuple):
            crossed = set(names) & {n.id for n in ast.walk(value) if isinstance(n, ast.Name)}
            parts = c.ordered([_later(c, part, bool(crossed)) for part in value.elts])
            count = len(parts)
        else:
            whole = expressions.value(c, value)
            if not isinstance(whole.kind, Fixed):
                c.refuse(node, f"{whole.kind.name} cannot be unpacked")
            count = len(whole.kind.entries)
            if whole.place == "value":
                whole = c.kept(whole)
            parts = [expressions.entry(c, whole, k, str(k), NOTHING) for k in range(count)]
        if len(names) != count:
            c.refuse(node, f"{count} values for {len(names)} variables")
        for name, part in zip(names, parts, strict=True):
            self._put(node, name, part)

    def augmented(self, node: ast.AugAssign, _: Block) -> bool:
        if not isinstance(node.target, ast.Name):
            self._c.refuse(node, "only variables can be assigned to")
        name = node.target.id
        read = ast.copy_location(ast.Name(name, ast.Load()), node)
        whole = ast.copy_location(ast.BinOp(read, node.op, node.value), node)
        self._put(node, name, expressions.value(self._c, whole))
        return True

    def expression(self, node: ast.Expr, _: Block) -> bool:
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            return True
        if not isinstance(node.value, ast.Call):
            self._c.refuse(node, "a value that nothing takes")
        self._c.emit(f"(void){expressions.value(self._c, node.value).within(UNARY)};")
        return True

    def condition(self, node: ast.If, block: Block) -> bool:
        c = self._c
        test = expressions.truth(c, node.test)
        c.emit(f"if ({test.text}) {{")
        before = set(c.bound)
        yes = self._inner(node.body, (*block[:-1], (block[-1][0], "body")))
        bound_yes, c.bound = c.bound, set(before)
        no = self._otherwise(node.orelse, (*block[:-1], (block[-1][0], "orelse")))
        if yes and no:
            c.bound &= bound_yes
        elif yes:
            c.bound = bound_yes
        return yes or no

    def _otherwise(self, body: list[ast.stmt], block: Block) -> bool:
        """What follows an `if`: nothing, another one, or a block."""
        c = self._c
        with c.apart() as made:
            going = self.block(body, block)
        lines = made.lines
        if len(body) == 1 and isinstance(body[0], ast.If) and lines[0].lstrip().startswith("if ("):
            c.made.lines += [f"{c.indent}}} else {lines[0].lstrip()}", *lines[1:]]
            return going
        if lines:
            c.emit("} else {")
            c.made.lines += [STEP + line for line in lines]
        c.emit("}")
        return going

    def _inner(self, body: list[ast.stmt], block: Block) -> bool:
        c = self._c
        with c.apart(deeper=True) as made:
            going = self.block(body, block)
        c.made.lines += made.lines
        return going

    def loop(self, node: ast.While, block: Block) -> bool:
        c = self._c
        if node.orelse:
            c.refuse(node, "else after a loop is outside the subset")
        with c.apart(deeper=True) as made:
            test = expressions.truth(c, node.test)
        endless = isinstance(node.test, ast.Constant) and node.test.value is True
        inner = (*block[:-1], (block[-1][0], "body"))
        bound = set(c.bound)
        if made.lines:
            c.emit("while (true) {")
            c.made.lines += [*made.lines, f"{c.indent}    if (!{test.within(UNARY)})"]
            c.made.lines.append(f"{c.indent}        break;")
        else:
            c.emit(f"while ({test.text}) {{")
        self._inner(node.body, inner)
        c.emit("}")
        c.bound = bound
        return not endless or any(isinstance(n, ast.Break) for n in ast.walk(node))

    def count(self, node: ast.For, block: Block) -> bool:
        c = self._c
        call = node.iter
        ranged = isinstance(call, ast.Call) and ast.unparse(call.func) == "range"
        if not ranged or not isinstance(call, ast.Call) or len(call.args) != 1 or call.keywords:
            c.refuse(node, "a loop goes over range(n)")
        if node.orelse or not isinstance(node.target, ast.Name):
            c.refuse(node, "a loop has one variable, and no else")
        name = node.target.id
        if name in c.loops or name in self._scopes or name in c.bound:
            c.refuse(node, f"{name} is another variable already: give the loop's its own name")
        limit = expressions.of_kind(c, call.args[0], WHOLE, f"range({ast.unparse(call.args[0])})")
        assigned = assigned_in(node.body)
        if name in assigned:
            c.refuse(node, f"the loop's variable {name} is assigned in the loop")
        fixed = limit.constant is not None or (limit.simple and not assigned & _names(call))
        if not fixed:
            limit = c.kept(limit)
        text = c.named(name)
        c.emit(f"for (int64_t {text} = 0; {text} < {limit.text}; {text}++) {{")
        bound = set(c.bound)
        c.loops[name] = None if limit.constant is None else int(limit.constant)
        c.kinds[name] = WHOLE
        c.bound.add(name)
        self._inner(node.body, (*block[:-1], (block[-1][0], "body")))
        c.emit("}")
        del c.loops[name]
        c.bound = bound
        return True

    def leave(self, node: ast.Break | ast.Continue, _: Block) -> bool:
        self._c.emit("break;" if isinstance(node, ast.Break) else "continue;")
        return False

    def nothing(self, node: ast.Pass, _: Block) -> bool:
        return True

    def back(self, node: ast.Return, _: Block) -> bool:
        c = self._c
        if node.value is None:
            c.refuse(node, "a function returns a value")
        value = expressions.of_kind(
            c, node.value, self._returns, f"`{flat(ast.unparse(node.value))[:60]}`"
        )
        c.emit(f"return {value.plain};")
        return False

    def fault(self, node: ast.Raise, _: Block) -> bool:
        c = self._c
        call = node.exc
        if (
            node.cause is not None
            or not isinstance(call, ast.Call)
            or ast.unparse(call.func) != "ValueError"
            or len(call.args) != 1
            or call.keywords
            or not isinstance(call.args[0], ast.Constant)
            or not isinstance(call.args[0].value, str)
        ):
            c.refuse(node, 'a failure is raise ValueError("constant text")')
        text = quoted(call.args[0].value)
        c.raising(frozenset({text}))
        c.emit(f"fail(fault, {text});")
        return False


def _later(c: Context, node: ast.expr, keep: bool) -> Callable[[], Value]:
    """An entry of a tuple that is taken apart at once; kept where a variable in it is assigned."""

    def found() -> Value:
        value = viewed(expressions.value(c, node))
        return c.kept(value) if keep else value

    return found


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def _targets(node: ast.stmt) -> set[str]:
    """Variables that a plain assignment gives a value without reading them."""
    if isinstance(node, ast.Assign) and len(node.targets) == 1:
        target = node.targets[0]
        value: ast.AST = node.value
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        target, value = node.target, node.value
    else:
        return set()
    elements = target.elts if isinstance(target, ast.Tuple) else [target]
    return {e.id for e in elements if isinstance(e, ast.Name)} - _names(value)


_HANDLERS: dict[type[ast.stmt], Callable[[Statements, Any, Block], bool]] = {
    ast.Assign: Statements.assign,
    ast.AnnAssign: Statements.annotated,
    ast.AugAssign: Statements.augmented,
    ast.Expr: Statements.expression,
    ast.If: Statements.condition,
    ast.While: Statements.loop,
    ast.For: Statements.count,
    ast.Break: Statements.leave,
    ast.Continue: Statements.leave,
    ast.Pass: Statements.nothing,
    ast.Return: Statements.back,
    ast.Raise: Statements.fault,
}
