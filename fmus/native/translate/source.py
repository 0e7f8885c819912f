"""A module's source: its functions, records and constants as syntax trees, with their place."""

from __future__ import annotations

import ast
import functools
import importlib.util
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import NoReturn

from ..errors import NativeError
from . import subset


@dataclass(frozen=True, eq=False)
class Source:
    """What a module's file says.

    `name` is short: that of the file, or of its folder for `physics.py`. `constants` are
    the lines on which they stand; `imported` maps a name to the module it comes from, and to the
    name it has there.
    """

    module: ModuleType
    path: Path
    name: str
    document: str
    functions: dict[str, ast.FunctionDef] = field(default_factory=dict)
    records: dict[str, ast.ClassDef] = field(default_factory=dict)
    constants: dict[str, int] = field(default_factory=dict)
    documents: dict[str, str] = field(default_factory=dict)
    imported: dict[str, tuple[str, str]] = field(default_factory=dict)

    def refuse(self, place: ast.AST | int, text: str) -> NoReturn:
        """Raise :class:`NativeError` with file and line."""
        line = place if isinstance(place, int) else getattr(place, "lineno", 1)
        where = "/".join(self.path.parts[-2:])
        raise NativeError(f"{where}:{line}: {text} ({subset.RULES})")


@functools.cache
def source_of(module: ModuleType) -> Source:
    """Read and sort the file of a module."""
    path = Path(str(module.__file__))
    tree = ast.parse(path.read_text(encoding="utf-8"))
    name = path.parent.name if path.stem == "physics" else path.stem
    found = Source(module, path, name, ast.get_docstring(tree) or "")
    before = ""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found.functions[node.name] = node
        elif isinstance(node, ast.ClassDef):
            found.records[node.name] = node
        elif isinstance(node, ast.ImportFrom) and node.level:
            origin = importlib.util.resolve_name(
                "." * node.level + (node.module or ""), str(module.__package__)
            )
            for alias in node.names:
                found.imported[alias.asname or alias.name] = (origin, alias.name)
        if isinstance(node, ast.Expr) and before:
            found.documents[before] = _text(node.value)
        before = _assigned(node)
        if before:
            found.constants[before] = node.lineno
    return found


def _assigned(node: ast.stmt) -> str:
    """Name of the one variable that a statement assigns to, or nothing."""
    targets: list[ast.expr] = []
    if isinstance(node, ast.Assign):
        targets = node.targets
    elif isinstance(node, ast.AnnAssign):
        targets = [node.target]
    if len(targets) == 1 and isinstance(targets[0], ast.Name):
        return targets[0].id
    return ""


def _text(node: ast.expr) -> str:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def home_of(source: Source, name: str) -> tuple[Source, str]:
    """Source and name under which a constant was first given, followed through the imports."""
    while name not in source.constants and name in source.imported:
        origin, name = source.imported[name]
        source = source_of(sys.modules[origin])
    return source, name
