"""What physics may be written in: the one list behind the translator and the test of the rules.

Statements and expressions are those that `statements` and `expressions` have a method for.
"""

from __future__ import annotations

import ast

PLAIN = ("fabs", "copysign", "atan", "atan2", "tanh", "asinh")
"""Functions of `math` without errors on real numbers."""

BOUNDED = ("sqrt", "sin", "cos", "tan", "asin", "acos", "log", "log1p", "log10", "log2")
"""Functions that cannot overflow: infinity out of a finite number is a pole."""

GROWING = ("sinh", "cosh", "exp", "expm1")
"""Functions that can overflow."""

ROUNDING = ("floor", "ceil")
"""Functions that give an int in Python, and a whole number in a double in C."""

ARGUMENTS = dict.fromkeys((*PLAIN, *BOUNDED, *GROWING, *ROUNDING), 1) | {
    "atan2": 2,
    "copysign": 2,
    "pow": 2,
}
"""Functions of `math` that physics may call, and how many arguments they take."""

CONSTANTS = ("pi",)
"""Constants of `math` that physics may use."""

BUILTINS = ("min", "max", "int", "float")
"""Functions of Python that physics may call; `range` stands in a `for` alone."""

OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
}

COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}

RULES = "docs/native-rules.md"
