"""The ten rules for native physics, held by reading the sources."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import fmus

ROOT = Path(fmus.__file__).parent
EXEMPT = {"monolith", "native"}
BUILD_TIME = {
    *("__init__.py", "slave.py", "film.py", "direct.py", "surrogate.py", "tables.py"),
    *("data.py", "making.py"),
}
SHARED = [ROOT / "law.py"]
FILES = [
    path
    for path in sorted(ROOT.glob("*/*.py"))
    if path.parent.name not in EXEMPT and path.name not in BUILD_TIME
] + SHARED
ALLOWED_MATH = {
    "pi", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan",
    "atan2", "sinh", "cosh", "tanh", "asinh", "exp", "expm1", "log",
    "log1p", "log10", "log2", "copysign", "fabs", "floor", "ceil", "pow",
}  # fmt: skip
FORBIDDEN = (
    ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.Lambda, ast.Try, ast.With,
    ast.Global, ast.Nonlocal, ast.Yield, ast.YieldFrom, ast.Await, ast.JoinedStr, ast.Dict,
    ast.Set, ast.List, ast.Delete, ast.Assert, ast.Starred,
)  # fmt: skip


def functions(tree: ast.Module) -> list[ast.FunctionDef]:
    return [node for node in tree.body if isinstance(node, ast.FunctionDef)]


@pytest.fixture(params=FILES, ids=lambda path: str(path.relative_to(ROOT)))
def tree(request: pytest.FixtureRequest) -> ast.Module:
    return ast.parse(request.param.read_text(encoding="utf-8"))


def test_dataclasses_are_frozen_floats_without_methods(tree: ast.Module) -> None:
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            assert [ast.unparse(d) for d in node.decorator_list] == ["dataclass(frozen=True)"]
            for entry in node.body:
                assert isinstance(entry, ast.AnnAssign | ast.Expr), ast.unparse(entry)
                if isinstance(entry, ast.AnnAssign):
                    assert ast.unparse(entry.annotation) == "float"


def test_functions_are_annotated_and_use_the_subset(tree: ast.Module) -> None:
    for function in functions(tree):
        assert function.returns is not None, function.name
        assert all(a.annotation is not None for a in function.args.args), function.name
        for node in ast.walk(function):
            assert not isinstance(node, FORBIDDEN), (function.name, ast.unparse(node))
            if isinstance(node, ast.BinOp):
                assert not isinstance(node.op, ast.Pow), (function.name, ast.unparse(node))
            if isinstance(node, ast.Raise):
                call = node.exc
                assert isinstance(call, ast.Call)
                assert ast.unparse(call.func) == "ValueError"
                assert isinstance(call.args[0], ast.Constant)


def test_only_the_allowed_mathematics(tree: ast.Module) -> None:
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "math":
            assert node.attr in ALLOWED_MATH, node.attr
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            assert node.module in {"__future__", "dataclasses"}, node.module
        if isinstance(node, ast.Import):
            assert [name.name for name in node.names] == ["math"]


def test_floats_are_written_as_floats(tree: ast.Module) -> None:
    """Whole numbers occur only as counts: in range() and i + 1, never beside a float."""
    for function in functions(tree):
        names = {
            inner.id
            for loop in ast.walk(function)
            if isinstance(loop, ast.For)
            for inner in ast.walk(loop.target)
            if isinstance(inner, ast.Name)
        }
        names |= {
            assign.targets[0].id
            for assign in ast.walk(function)
            if isinstance(assign, ast.Assign)
            and isinstance(assign.targets[0], ast.Name)
            and "int(" in ast.unparse(assign.value)
            and "float(int(" not in ast.unparse(assign.value)
        }
        for node in ast.walk(function):
            if isinstance(node, ast.BinOp | ast.Compare):
                parts = (
                    [node.left, node.right]
                    if isinstance(node, ast.BinOp)
                    else [node.left, *node.comparators]
                )
                whole = [p for p in parts if isinstance(p, ast.Constant) and type(p.value) is int]
                others = [p for p in parts if p not in whole]
                if whole:
                    assert all(_counts(p, names) for p in others), (
                        function.name,
                        ast.unparse(node),
                    )


def _counts(node: ast.expr, loops: set[str]) -> bool:
    """A loop variable, a whole constant, or the result of int()."""
    if isinstance(node, ast.Name):
        return node.id in loops or node.id.isupper()
    return isinstance(node, ast.Call) and ast.unparse(node.func) == "int"


def test_records_are_built_with_all_fields_by_name(tree: ast.Module) -> None:
    records = {
        node.name: [e.target.id for e in node.body if isinstance(e, ast.AnnAssign)]  # type: ignore[union-attr]
        for node in tree.body
        if isinstance(node, ast.ClassDef)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            fields = records.get(node.func.id)
            if fields is not None:
                assert not node.args
                assert sorted(k.arg or "" for k in node.keywords) == sorted(fields)
