"""The rules for native physics: every function of it translates, whether a part calls it or not."""

from __future__ import annotations

import ast
import dataclasses
import importlib
from pathlib import Path
from types import ModuleType

import pytest

import fmus
from fmus.native.translate import unit
from fmus.native.translate.source import source_of

ROOT = Path(fmus.__file__).parent
EXEMPT = {"monolith", "native", "export"}
BUILD_TIME = {
    *("__init__.py", "slave.py", "film.py", "ritz_solver.py", "surrogate.py", "tables.py"),
    *("data.py", "generate.py", "measured.py"),
}
FILES = [
    path
    for path in sorted(ROOT.glob("*/*.py"))
    if path.parent.name not in EXEMPT and path.name not in BUILD_TIME
] + [ROOT / "law.py", ROOT / "monolith" / "equations.py"]
IMPORTED = {"__future__", "dataclasses", "math"}


@pytest.fixture(params=FILES, ids=lambda path: str(path.relative_to(ROOT)))
def module(request: pytest.FixtureRequest) -> ModuleType:
    parts = request.param.relative_to(ROOT).with_suffix("").parts
    return importlib.import_module(".".join(["fmus", *parts]))


def test_every_function_and_record_translates(module: ModuleType) -> None:
    """:class:`NativeError` would name file, line and what is outside the subset."""
    source = source_of(module)
    records = {name: vars(module)[name] for name in source.records}
    assert all(dataclasses.is_dataclass(record) for record in records.values())
    translation = unit.translated(module, "whole", list(source.functions), records)
    for name in source.functions:
        assert f"whole_{name}(" in translation.source


def test_nothing_else_is_imported(module: ModuleType) -> None:
    """A name that no function uses does not reach the translator."""
    for node in ast.walk(ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            assert node.module in IMPORTED
        if isinstance(node, ast.Import):
            assert {name.name for name in node.names} <= IMPORTED
