"""Numbers and tables of a module as constants of C."""

from __future__ import annotations

from typing import Any

from .text import WIDTH, literal


def shape_of(given: Any) -> tuple[int, ...] | str:
    """Shape of a nested tuple of floats; what is wrong with it where it is not a table."""
    if not isinstance(given, tuple):
        return () if isinstance(given, float) else f"holds {given!r}, which is not a float"
    if not given:
        return "is empty"
    inner: tuple[int, ...] | None = None
    for entry in given:
        found = shape_of(entry)
        if isinstance(found, str):
            return found
        if inner is not None and found != inner:
            return "has rows of different lengths"
        inner = found
    return (len(given), *(inner or ()))


def number(name: str, given: Any) -> list[str]:
    """Definition of a number or a truth value."""
    if isinstance(given, bool):
        return [f"static const bool {name} = {str(given).lower()};"]
    if isinstance(given, int):
        return [f"static const int64_t {name} = {given};"]
    return [f"static const double {name} = {literal(given)};"]


def table(name: str, given: Any, shape: tuple[int, ...]) -> list[str]:
    """Definition of a table, as many numbers on a line as there is room for."""
    sizes = "".join(f"[{size}]" for size in shape)
    return [f"static const double {name}{sizes} = {{", *_rows(given, "    "), "};"]


def _rows(given: Any, indent: str) -> list[str]:
    if isinstance(given[0], tuple):
        made = []
        for row in given:
            inner = _rows(row, indent + "    ")
            if len(inner) == 1 and len(inner[0]) + 3 <= WIDTH:
                made.append(f"{indent}{{{inner[0].strip().rstrip(',')}}},")
            else:
                made += [f"{indent}{{", *inner, f"{indent}}},"]
        return made
    lines: list[str] = []
    line = indent
    for entry in given:
        word = f"{literal(entry)}, "
        if len(line) + len(word) - 1 > WIDTH:
            lines.append(line.rstrip())
            line = indent
        line += word
    return [*lines, line.rstrip()]
