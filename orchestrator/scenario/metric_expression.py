"""Metrics as a scenario writes them: `peak_to_peak(linkage.flap_angle) in deg`.

An expression is a function of recorded variables over the window of the last cycles, or a sum,
product or power of such functions and numbers. Inside a function variables may be combined in the
same way. A variable whose name has more than letters, digits, `_`, `.` and `[n]` is quoted.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Container, Iterator
from dataclasses import dataclass

from ..errors import nearest, printable
from ..units import check_unit, factor

FUNCTIONS = {
    "max": "largest value, of one variable or of several",
    "min": "least value, of one variable or of several",
    "mean": "mean over time, by the trapezoidal rule",
    "rms": "root of the mean square over time",
    "first": "value at the beginning of the window",
    "last": "value at the end of the window",
    "peak_to_peak": "largest value minus least value",
    "rate": "change over the window divided by its length: the mean rate, exact for a counter",
    "frequency": "mean frequency of the upward crossings of the middle value",
    "phase": "lag of the first argument's fundamental behind that of the second",
}
SAME_UNIT = {"max", "min", "mean", "rms", "first", "last", "peak_to_peak"}
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
LONGEST = 500
UNIT = re.compile(r"(?s)(.*\S)\s+in\s+(\S+)\s*")


@dataclass(frozen=True)
class Expression:
    """A metric: its tree, the variables it needs, and the unit to show it in ("" for none)."""

    tree: ast.expr
    variables: tuple[str, ...]
    unit: str


def expression_of(text: str) -> Expression:
    """Read an expression; `ValueError` names what cannot be read."""
    if len(text) > LONGEST:
        raise ValueError(f"longer than {LONGEST} characters")
    match = UNIT.fullmatch(text)
    body, unit = (match[1], match[2]) if match else (text.strip(), "")
    try:
        tree = ast.parse(body, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError(
            "cannot be read; write function(component.variable) in unit, as max(tank.level) in m"
        ) from None
    if _is_series(tree):
        known = ", ".join(FUNCTIONS)
        raise ValueError(f"is a series over time and not one number; apply one of {known}")
    return Expression(tree, tuple(dict.fromkeys(_variables(tree))), unit)


def not_recorded(expression: Expression, recorded: Container[str]) -> str:
    """Why a metric is left out whose variables are not all `recorded`, and the way out."""
    lacking = [json.dumps(name) for name in expression.variables if name not in recorded]
    if not lacking:
        return ""
    listed = ", ".join(map(printable, lacking))
    return f"not recorded; under [record] write variables = [{listed}]"


def _variables(node: ast.AST) -> Iterator[str]:
    """Variables of a tree, from left to right."""
    name = variable_of(node)
    if name is not None:
        yield name
        return
    inside = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
    for each in inside:
        yield from _variables(each)


def variable_of(node: ast.AST) -> str | None:
    """The variable that a node names: `a.b`, `a.b[1]` or a quoted name; else None."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        owner = variable_of(node.value)
        return None if owner is None else f"{owner}.{node.attr}"
    if isinstance(node, ast.Subscript):
        owner = variable_of(node.value)
        index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if owner is None or not all(_whole(each) for each in index):
            return None
        return f"{owner}[{','.join(ast.unparse(each) for each in index)}]"
    return None


def unit_of(expression: Expression, units: dict[str, str]) -> str:
    """Unit in which a metric is shown, from those of its variables; "1" where it is not known.

    Raises `UnitError` where the unit asked for is of another dimension than the metric.
    """
    tree = expression.tree
    own = ""
    if isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name):
        function = tree.func.id
        names = [variable_of(argument) for argument in tree.args]
        if function == "frequency":
            own = "Hz"
        elif function == "phase":
            own = "rad"
        elif names and names[0] in units and names[0] is not None:
            given = units[names[0]]
            if function in SAME_UNIT and None not in names:
                own = given or "1"
            elif function == "rate":
                own = f"{given}/s" if given not in {"", "1"} else "1/s"
    if expression.unit and own:
        factor(own, expression.unit)
    elif expression.unit:
        check_unit(expression.unit)
    return expression.unit or own or "1"


def _is_series(node: ast.expr) -> bool:
    """Whether a node has a value at every time; `ValueError` where it is not an expression."""
    if variable_of(node) is not None:
        return True
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        if isinstance(node.value, bool):
            raise ValueError(f"{node.value} is not a number")
        return False
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        return _is_series(node.operand)
    if isinstance(node, ast.BinOp) and isinstance(node.op, OPERATORS):
        return _is_series(node.left) | _is_series(node.right)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        _check_call(node.func.id, node.args)
        return False
    raise ValueError(f"{ast.unparse(node)!r} is not a variable, a number, a sum or a product")


def _check_call(function: str, arguments: list[ast.expr]) -> None:
    if function not in FUNCTIONS:
        raise ValueError(f"no function {function!r}; {nearest(function, FUNCTIONS, show=12)}")
    wanted = {"phase": 2}.get(function, 1)
    if len(arguments) < wanted or (len(arguments) > wanted and function not in {"max", "min"}):
        raise ValueError(f"{function} takes {wanted} argument{'s' * (wanted > 1)}")
    for argument in arguments:
        if not _is_series(argument):
            raise ValueError(f"{function}({ast.unparse(argument)}): is not a variable over time")


def _whole(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int)
