"""Where in a function's blocks each variable lives, so that C declares it there and only there."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

Block = tuple[tuple[int, str], ...]
"""A block: from the body inwards, the statement's number and which part of it."""


@dataclass(frozen=True)
class Scope:
    """The block that has all uses of a variable, and the number of the first statement with one.

    `once` where the variable is assigned at one place only.
    """

    block: Block
    first: int
    once: bool


def stored_in(function: ast.FunctionDef) -> frozenset[str]:
    """Parameters and all names that a function assigns to."""
    names = {argument.arg for argument in function.args.args}
    names |= {n.id for n in ast.walk(function) if isinstance(n, ast.Name) and _stores(n)}
    return frozenset(names)


def read_in(function: ast.FunctionDef) -> frozenset[str]:
    """All names that a function's body reads."""
    inner = [node for statement in function.body for node in ast.walk(statement)]
    read = {n.id for n in inner if isinstance(n, ast.Name) and not _stores(n)}
    added = {
        n.target.id
        for n in inner
        if isinstance(n, ast.AugAssign) and isinstance(n.target, ast.Name)
    }
    return frozenset(read | added)


def assigned_in(statements: list[ast.stmt]) -> frozenset[str]:
    """Names that some statements assign to."""
    inner = [node for statement in statements for node in ast.walk(statement)]
    return frozenset(n.id for n in inner if isinstance(n, ast.Name) and _stores(n))


def scopes(function: ast.FunctionDef) -> dict[str, Scope]:
    """Where each variable of a function lives, its parameters and loop variables left out."""
    loops = {
        n.target.id
        for n in ast.walk(function)
        if isinstance(n, ast.For) and isinstance(n.target, ast.Name)
    }
    outside = {argument.arg for argument in function.args.args} | loops
    seen: dict[str, list[tuple[Block, int, bool]]] = {}
    for name, block, number, stores in _uses(function.body, ()):
        if name not in outside:
            seen.setdefault(name, []).append((block, number, stores))
    found = {}
    for name, uses in seen.items():
        if not any(stores for _, _, stores in uses):
            continue
        home = _common([block for block, _, _ in uses])
        firsts = [number if block == home else block[len(home)][0] for block, number, _ in uses]
        once = sum(stores for _, _, stores in uses) == 1
        found[name] = Scope(home, min(firsts), once)
    return found


def _stores(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)


def _uses(body: list[ast.stmt], block: Block) -> Iterator[tuple[str, Block, int, bool]]:
    """Every occurrence of a name: its block, the statement's number, whether it is assigned."""
    for number, statement in enumerate(body):
        own: list[ast.AST] = [statement]
        if isinstance(statement, ast.If | ast.While | ast.For):
            own = [statement.iter] if isinstance(statement, ast.For) else [statement.test]
            for part in ("body", "orelse"):
                yield from _uses(getattr(statement, part), (*block, (number, part)))
        for node in own:
            for inner in ast.walk(node):
                if isinstance(inner, ast.Name):
                    yield inner.id, block, number, _stores(inner)


def _common(blocks: list[Block]) -> Block:
    """The innermost block that has all these in it."""
    shortest = min(blocks, key=len)
    for length in range(len(shortest), -1, -1):
        if all(block[:length] == shortest[:length] for block in blocks):
            return shortest[:length]
    return ()
