"""The header `part.h` that `instance.h` needs: a part's records, variables and bounds."""

from __future__ import annotations

from ..part import Part, Variable
from .fmi3_description import EVENT
from .translate.text import literal, quoted
from .translate.unit import DERIVATIVES, ENTRIES, Translation


def header(part: Part, guid: str, variables: list[Variable], translation: Translation) -> str:
    """C text with the part's functions and records, and its variables by value reference."""
    count = {
        kind: sum(v.causality == kind for v in variables)
        for kind in ("input", "parameter", "output")
    }
    lines = [
        "/* What layer.c has to know of the part; made by the build. */",
        *records(translation),
        *(f"#define PART_{e.upper()} {translation.name}_{e}" for e in ENTRIES),
        *(f"#define PART_DUAL_{e.upper()} {translation.name}_dual_{e}" for e in DERIVATIVES),
        "",
        f"#define GUID {quoted(guid)}",
        f"#define INPUTS {count['input']}",
        f"#define PARAMETERS {count['parameter']}",
        f"#define OUTPUTS {count['output']}",
        *(f"#define EVENT {k}" for k, v in enumerate(variables) if v.name == EVENT),
        "",
        "typedef struct {",
        "    const char *name;",
        "    double start, least, most;",
        "    const char *bounds;",
        "} Variable;",
        "",
        "static const Variable variables[] = {",
        *(f"    {_row(variable)}," for variable in variables),
        "};",
    ]
    return "\n".join([*lines, ""])


def records(translation: Translation) -> list[str]:
    """The translation's header, and its records under the names that were asked for."""
    names = translation.names.items()
    aliases = [f"typedef {made} {name};" for name, made in names if made != name]
    return [f'#include "{translation.name}.h"', "", *aliases]


def _row(variable: Variable) -> str:
    """Initialiser of one variable; the bounds are worded as the Python slave words them."""
    quantity = variable.quantity
    least, most = quantity.least, quantity.most
    low = "-HUGE_VAL" if least is None else literal(least)
    high = "HUGE_VAL" if most is None else literal(most)
    words = f"{'-inf' if least is None else least} to {'inf' if most is None else most}"
    fields = (
        quoted(variable.name),
        literal(variable.start),
        low,
        high,
        quoted(f"{words} {quantity.unit}"),
    )
    return "{" + ", ".join(fields) + "}"
