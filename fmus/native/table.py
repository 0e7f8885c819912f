"""The header `table.h` that `layer.c` is compiled with: a part's variables and words."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

from ..part import Part, Variable


def header(part: Part, guid: str, variables: list[Variable], causes: list[str]) -> str:
    """C text with the sizes of the records, the variables by value reference, the causes."""
    count = {
        kind: sum(v.causality == kind for v in variables)
        for kind in ("input", "parameter", "output")
    }
    physics: Any = part.physics
    lines = [
        f"#define GUID {json.dumps(guid)}",
        f"#define INPUTS {count['input']}",
        f"#define PARAMETERS {count['parameter']}",
        f"#define OUTPUTS {count['output']}",
        f"#define STATES {len(dataclasses.fields(physics.State))}",
        "typedef struct {",
        "    const char *name;",
        "    double start, least, most;",
        "    const char *bounds;",
        "} Variable;",
        "static const Variable variables[] = {",
        *(f"    {_row(variable)}," for variable in variables),
        "};",
        "static const char *const causes[] = {",
        '    "no cause",',
        *(f"    {json.dumps(cause)}," for cause in causes),
        "};",
    ]
    return "\n".join([*lines, ""])


def _row(variable: Variable) -> str:
    """Initialiser of one variable; the bounds are worded as the Python slave words them."""
    quantity = variable.quantity
    least, most = quantity.least, quantity.most
    low = "-HUGE_VAL" if least is None else least.hex()
    high = "HUGE_VAL" if most is None else most.hex()
    words = f"{'-inf' if least is None else least} to {'inf' if most is None else most}"
    fields = (
        json.dumps(variable.name),
        variable.start.hex(),
        low,
        high,
        json.dumps(f"{words} {quantity.unit}"),
    )
    return "{" + ", ".join(fields) + "}"
