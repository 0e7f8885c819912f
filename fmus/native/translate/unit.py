"""A translation unit: all that some functions of the physics need, in one `.c` and one `.h`."""

from __future__ import annotations

import ast
import dataclasses
import sys
import typing
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import FunctionType, ModuleType
from typing import Any

from . import function as functions
from .arithmetic import Dual, Plain
from .calls import Signature
from .context import Context
from .expressions import constant_of
from .function import Function
from .kinds import FLOAT, NUMBERS, Fixed, Kind, Record, Scalar, Table, View
from .names import Names, local
from .source import Source, home_of, source_of
from .tables import number, shape_of, table
from .text import STEP, comment, wrapped
from .value import Value

ENTRIES = ("initial", "advance", "observe")
DERIVATIVES = ("initial", "observe")
RECORDS = ("Params", "State", "Input", "Output")


@dataclass(frozen=True)
class Translation:
    """Two files, and the C names of the records that were asked for."""

    name: str
    header: str
    source: str
    names: dict[str, str]


@dataclass
class Section:
    """What one module brings to the file: its constants and its functions."""

    constants: list[str] = field(default_factory=list)
    functions: dict[int, Function] = field(default_factory=dict)


class Unit:
    """The file in the making; modules of other packages than the first one's stay out.

    `entries` are the functions that other files may call, by module and name, with their C names.
    A unit `beside` another one has its functions on dual numbers, in the same file: it shares the
    other's names and constants.
    """

    def __init__(
        self, first: Source, entries: dict[tuple[str, str], str], beside: Unit | None = None
    ) -> None:
        self.arithmetic = Plain() if beside is None else Dual()
        self._package = first.module.__name__.split(".")[0]
        self._named = entries
        self._first = first
        self._functions: dict[tuple[str, str], Function] = {}
        self._open: list[tuple[str, str]] = []
        self._records: dict[type[Any], str] = {}
        self._structs: dict[Kind, list[str]] = {}
        self._aliases: dict[Fixed, str] = {}
        self._fixed: dict[Fixed, str] = {}
        self._sections: dict[Source, Section] = {}
        self._entries: list[Function] = []
        self._names: Names = Names() if beside is None else beside._names
        self._constants: dict[tuple[str, str], str] = {} if beside is None else beside._constants
        self._tables: dict[int, str] = {} if beside is None else beside._tables
        self._defined: dict[Source, Section] = self._sections if beside is None else beside._defined
        if beside is not None:
            return
        scope = vars(first.module)
        plain = [n for n in first.constants if isinstance(scope.get(n), int | float | tuple)]
        for name in (*first.records, *first.functions, *plain):
            self._names.given((first.module.__name__, name), name, (first.name,))

    # ---- what expressions ask for ----

    def source(self, c: Context, node: ast.AST, module: ModuleType) -> Source:
        """Source of a module of the package; refused where it is from elsewhere."""
        if module.__name__.split(".")[0] != self._package:
            c.refuse(node, f"{module.__name__} is outside the subset")
        return source_of(module)

    def function(self, c: Context, node: ast.AST, found: FunctionType) -> Signature:
        """The signature of a function, which is translated before its caller."""
        module = sys.modules[found.__module__]
        source = self.source(c, node, module)
        key = (module.__name__, found.__name__)
        if key in self._open:
            c.refuse(node, f"{found.__name__}() calls itself, which is outside the subset")
        return self.translated(source, found).signature

    def translated(self, source: Source, found: FunctionType) -> Function:
        """Translate a function once."""
        key = (source.module.__name__, found.__name__)
        if key not in self._functions:
            self._open.append(key)
            entry = self._named.get(key, "")
            name = entry or self._given(source, self.arithmetic.function(found.__name__))
            made = functions.translated(self, source, found, name, entry=bool(entry))
            self._open.pop()
            self._functions[key] = made
            section = self._sections.setdefault(source, Section())
            section.functions[source.functions[found.__name__].lineno] = made
            if entry:
                self._entries.append(made)
        return self._functions[key]

    def fields(self, kind: Record) -> dict[str, Kind]:
        """The fields of a record with their types."""
        self.c_type(kind)
        hints = typing.get_type_hints(kind.source)
        return {
            f.name: FLOAT if hints[f.name] is float else Record(hints[f.name])
            for f in dataclasses.fields(kind.source)
        }

    def field_name(self, name: str) -> str:
        """C name of a field."""
        return local(name, frozenset())

    def known_as(self, kind: Kind, name: str, source: Source) -> None:
        """Note the name that a module has for a type of tuple, and declare what is annotated."""
        if isinstance(kind, Fixed) and not kind.uniform and name:
            self._aliases.setdefault(kind, name)
        self.c_type(kind)

    def c_type(self, kind: Kind) -> str:
        """Name of a type in C; records and tuples are declared when they are first asked for."""
        if kind in NUMBERS:
            return self.arithmetic.number
        if isinstance(kind, Scalar):
            return kind.c
        if isinstance(kind, View):
            return "Row" if kind.dimensions == 1 else "Table"
        if isinstance(kind, Record):
            return self._record(kind.source)
        if isinstance(kind, Table):
            raise AssertionError("a table of known shape has no type of its own")
        return self._tuple(kind)

    def global_value(self, c: Context, node: ast.expr, source: Source, name: str) -> Value:
        """A module's constant; numbers are named, tables have their shape."""
        given = vars(source.module).get(name)
        if not isinstance(given, bool | int | float | tuple):
            c.refuse(node, f"{ast.unparse(node)} is not a number or a table of numbers")
        home, original = home_of(source, name)
        if home.module.__name__.split(".")[0] != self._package or original not in home.constants:
            c.refuse(node, f"{ast.unparse(node)}: no module of the package assigns it")
        line = home.constants[original]
        if isinstance(given, tuple):
            shape = shape_of(given)
            if isinstance(shape, str):
                home.refuse(line, f"the table {original} {shape}")
            return Value(c.shared(self._table(home, original, given, shape)), Table(shape))
        plain = constant_of(c, node, given)
        text, rank = c.shared(self._constant(home, original, given)), 0
        if plain.kind == FLOAT:
            text, rank = self.arithmetic.constant(text)
        return dataclasses.replace(plain, text=text, rank=rank)

    # ---- what is declared ----

    def _given(self, source: Source, name: str) -> str:
        above = source.path.parent.name
        modules = (source.name, f"{above}_{source.name}")
        return self._names.given((source.module.__name__, name), name, modules)

    def _record(self, record: type[Any]) -> str:
        """Declare a dataclass as a struct."""
        if record in self._records:
            return self._records[record]
        source = source_of(sys.modules[record.__module__])
        node = source.records.get(record.__name__)
        if node is None or not _frozen(record):
            source.refuse(node or 1, f"{record.__name__} is not a frozen dataclass of this file")
        for entry in node.body:
            if not isinstance(entry, ast.AnnAssign | ast.Expr | ast.Pass):
                source.refuse(entry, f"{record.__name__}: fields only")
        hints: dict[str, Any] = typing.get_type_hints(record)
        members: list[tuple[str, str]] = []
        for f in dataclasses.fields(record):
            kind = hints[f.name]
            if kind is not float and not dataclasses.is_dataclass(kind):
                source.refuse(_line(node, f.name), f"{record.__name__}.{f.name} is not a float")
            made = self.arithmetic.number if kind is float else self._record(hints[f.name])
            members.append((f"{made} {self.field_name(f.name)};", _meaning(f)))
        own = self.arithmetic.record(record.__name__)
        name = self._records[record] = self._given(source, own)
        width = max((len(text) for text, _ in members), default=0)
        body = [
            f"{STEP}{text.ljust(width)}  {comment(meaning)[0]}" if meaning else STEP + text
            for text, meaning in members
        ]
        body = body or [f"{STEP}char none;"]
        document = comment(ast.get_docstring(node) or "")
        self._structs[Record(record)] = [*document, "typedef struct {", *body, f"}} {name};"]
        return name

    def _tuple(self, kind: Fixed) -> str:
        """Declare a type of tuple as a struct."""
        if kind not in self._fixed:
            count = len(kind.entries)
            if kind.uniform:
                name, body = f"Floats{count}", [f"{STEP}{self.arithmetic.number} at[{count}];"]
            else:
                body = [
                    f"{STEP}{self.c_type(entry)} item{k};" for k, entry in enumerate(kind.entries)
                ]
                name = self._aliases.get(kind, f"Tuple{len(self._fixed) + 1}")
            name = self.arithmetic.record(name)
            name = self._names.given((self.arithmetic.number, kind), name, ("tuple",))
            self._fixed[kind] = name
            self._structs[kind] = ["typedef struct {", *body, f"}} {name};"]
        return self._fixed[kind]

    def _table(self, home: Source, name: str, given: Any, shape: tuple[int, ...]) -> str:
        """Define a table, once whatever its names."""
        if id(given) not in self._tables:
            made = self._tables[id(given)] = self._given(home, name)
            self._define(home, name, table(made, given, shape))
        return self._tables[id(given)]

    def _constant(self, home: Source, name: str, given: Any) -> str:
        """Define a number."""
        key = (home.module.__name__, name)
        if key not in self._constants:
            made = self._constants[key] = self._given(home, name)
            self._define(home, name, number(made, given))
        return self._constants[key]

    def _define(self, home: Source, name: str, lines: list[str]) -> None:
        section = self._defined.setdefault(home, Section())
        section.constants += ["", *comment(home.documents.get(name, "")), *lines]

    # ---- the files ----

    def asked(self, records: dict[str, type[Any]]) -> dict[str, str]:
        """The C names of records, by the names to ask with."""
        return {asked: self._record(record) for asked, record in records.items()}

    def declared(self, records: dict[str, type[Any]]) -> tuple[list[str], list[str]]:
        """The structs and entries that other files see, and the structs that they do not."""
        public = set().union(*(self._inside(Record(record)) for record in records.values()))
        for entry in self._entries:
            signature = entry.signature
            for kind in (signature.returns, *(p.kind for p in signature.parameters)):
                public |= self._inside(kind)
        head: list[str] = []
        body: list[str] = []
        for owner, lines in self._structs.items():
            (head if owner in public else body).extend(["", *lines])
        for entry in self._entries:
            head += ["", *entry.comment, *wrapped(f"INTERNAL {entry.head};", "")]
        return head, body

    def constants(self) -> list[str]:
        """The constants, module by module, in the order of the source."""
        lines = []
        for source, section in self._in_order().items():
            document = "" if source is self._first else f"\n\n{source.document}"
            lines += ["", *comment(f"---- {_place(source)} ----{document}"), *section.constants]
        return lines

    def code(self, title: str) -> list[str]:
        """Declarations and functions, module by module, in the order of the source."""
        lines = ["", f"/* ---- {title} ---- */", ""]
        sections = self._in_order()
        for section in sections.values():
            for _, made in sorted(section.functions.items()):
                if made not in self._entries:
                    lines += wrapped(f"{self.arithmetic.declared} {made.head};", "")
        for source, section in sections.items():
            if section.functions:
                lines += ["", f"/* ---- {_place(source)} ---- */"]
            for _, made in sorted(section.functions.items()):
                lines += ["", *made.comment, *made.text]
        return lines

    def _in_order(self) -> dict[Source, Section]:
        """The sections, the first module's own before all others."""
        return {self._first: self._sections.get(self._first, Section())} | self._sections

    def _inside(self, kind: Kind) -> set[Kind]:
        """A struct and the structs within it."""
        inner: list[Kind] = []
        if isinstance(kind, Record):
            inner = [*self.fields(kind).values()]
        elif isinstance(kind, Fixed):
            inner = [*kind.entries]
        else:
            return set()
        return {kind}.union(*(self._inside(each) for each in inner))


def _place(source: Source) -> str:
    return "/".join(source.path.parts[-2:])


def _frozen(record: type[Any]) -> bool:
    return bool(record.__dataclass_params__.frozen)


def _line(node: ast.ClassDef, name: str) -> ast.AST:
    """The line that declares a field."""
    for entry in node.body:
        if isinstance(entry, ast.AnnAssign) and ast.unparse(entry.target) == name:
            return entry
    return node


def _meaning(entry: dataclasses.Field[Any]) -> str:
    """What a declared field means, with its unit."""
    quantity = entry.metadata.get("quantity")
    return f"{quantity.meaning} [{quantity.unit}]" if quantity else ""


def translated(
    module: ModuleType,
    name: str,
    entries: Sequence[str],
    records: dict[str, type[Any]],
    derivatives: Sequence[str] = (),
) -> Translation:
    """Some functions of a module with all that they call, as `NAME_FUNCTION` in two files.

    `derivatives` are those that are there on dual numbers too, as `NAME_dual_FUNCTION`, with the
    records as `DualRECORD`.
    """
    plain = _unit(module, f"{name}_", entries, None)
    dual = _unit(module, f"{name}_dual_", derivatives, plain) if derivatives else None
    names = plain.asked(records)
    first = source_of(module)
    notice = comment(f"Made from {first.name}'s physics by the build; nothing to edit.")
    guard = f"{name.upper()}_H"
    head, body = plain.declared(records)
    code = plain.code("functions")
    base = "semantics.h"
    if dual is not None:
        names |= {f"Dual{asked}": made for asked, made in dual.asked(records).items()}
        dual_head, dual_body = dual.declared(records)
        head, body = [*head, *dual_head], [*body, *dual_body]
        code += dual.code("the same on dual numbers")
        base = "dual.h"
    guarded = [f"#ifndef {guard}", f"#define {guard}", "", f'#include "{base}"', *head]
    head = [*notice, *guarded, "", "#endif", ""]
    include = f'#include "{name}.h"'
    body = [*comment(first.document), include, *body, *plain.constants(), *code, ""]
    return Translation(name, "\n".join(head), "\n".join(body), names)


def _unit(module: ModuleType, prefix: str, entries: Sequence[str], beside: Unit | None) -> Unit:
    """A unit with the functions of those names and all that they call."""
    chosen = [getattr(module, entry) for entry in entries]
    named = {(f.__module__, f.__name__): f"{prefix}{f.__name__}" for f in chosen}
    unit = Unit(source_of(module), named, beside)
    for found in chosen:
        unit.translated(source_of(sys.modules[found.__module__]), found)
    return unit


def part(physics: ModuleType, name: str) -> Translation:
    """The physics of a part: its entries, and the derivatives of its outputs."""
    records = {record: getattr(physics, record) for record in RECORDS}
    return translated(physics, name, ENTRIES, records, DERIVATIVES)
