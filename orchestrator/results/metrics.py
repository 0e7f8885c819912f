"""Metrics of a run: those that its scenario defines, taken over the last whole cycles."""

from __future__ import annotations

import ast
import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..scenario.metric_expression import (
    Expression,
    expression_of,
    not_recorded,
    unit_of,
    variable_of,
)
from ..units import UnitError, in_base
from .outcome import Outcome
from .recorded import Recorded, recorded
from .window import Window

if TYPE_CHECKING:
    import xarray

CYCLES = 5
"""Cycles of the window where a scenario gives none."""
MOST_UNASKED = 4
"""Leading variables that a scenario without metrics shows the last value of."""


@dataclass(frozen=True)
class Metric:
    """One row of the table: name, value in SI with its unit, and how it is shown.

    Where there is no number, `value` is NaN and `shown` gives the reason. `error` is estimated, in
    SI, and `shown_error` how it is shown; None and "" where there is no estimate.
    """

    name: str
    value: float
    unit: str
    shown: str
    error: float | None = None
    shown_error: str = ""


@dataclass(frozen=True)
class LeftOut:
    """A metric that a result has no row for, with the reason and the way out."""

    name: str
    reason: str


def metrics(source: Recorded | Outcome | xarray.Dataset, cycles: int | None = None) -> list[Metric]:
    """The metrics of the scenario that a result comes from, over its last `cycles` cycles.

    Those whose variables were not recorded are left out, as are a frequency and a phase of a
    variable that does not move: see `left_out`. A scenario that defines none gets the last value of
    its first variables.
    """
    return [each for each in _taken(source, cycles) if isinstance(each, Metric)]


def left_out(source: Recorded | Outcome | xarray.Dataset) -> list[LeftOut]:
    """The metrics of the scenario that `metrics` leaves out."""
    return [each for each in _taken(source, None) if isinstance(each, LeftOut)]


def _taken(
    source: Recorded | Outcome | xarray.Dataset, cycles: int | None
) -> Iterator[Metric | LeftOut]:
    data = recorded(source)
    settings = data.metrics or {}
    window = Window(data, cycles or int(settings.get("cycles", CYCLES)))
    defined = {str(k): str(v) for k, v in settings.items() if k != "cycles"}
    yield from _found(window, texts_of(defined, window.units), data.metric_errors)


def texts_of(defined: Mapping[str, str], names: Iterable[str]) -> Mapping[str, str]:
    """Expressions by metric: those defined, else the last values of the first of the variables."""
    first = itertools.islice(names, MOST_UNASKED)
    return defined or {f"last {name}": f"last({json.dumps(name)})" for name in first}


def _found(
    window: Window, defined: Mapping[str, str], errors: Mapping[str, float]
) -> Iterator[Metric | LeftOut]:
    for name, text in defined.items():
        try:
            expression = expression_of(text)
            if reason := not_recorded(expression, window.units):
                yield LeftOut(name, reason)
                continue
            shown_in = unit_of(expression, window.units)
            unit, scale = _base(shown_in)
        except (ValueError, UnitError) as error:
            yield Metric(name, math.nan, "1", f"not a number: {error}")
            continue
        if window.rows < Window.LEAST_ROWS:
            reason = f"{window.rows} rows are fewer than the {Window.LEAST_ROWS} that it needs"
            yield Metric(name, math.nan, unit, f"not a number: {reason}")
            continue
        try:
            value = evaluated(expression, window)
        except Window.UndefinedError as undefined:
            yield LeftOut(name, f"{text} {undefined}")
            continue
        if not math.isfinite(value):
            yield Metric(name, math.nan, unit, f"not a number: {text} comes to {value}")
            continue
        wrong = errors.get(name)
        about = "" if wrong is None else shown(wrong / scale, shown_in, digits=2)
        yield Metric(name, value, unit, shown(value / scale, shown_in), wrong, about)


def evaluated(expression: Expression, window: Window) -> float:
    """Value of a metric in SI; `UndefinedError` where a frequency or phase does not exist."""
    with np.errstate(all="ignore"):
        try:
            return float(_scalar(expression.tree, window))
        except (ZeroDivisionError, OverflowError):
            return math.nan


def shown(number: float, unit: str, digits: int = 4) -> str:
    """A number to four digits with its unit, as `63.31 deg`."""
    text = f"{number:#.{digits}g}".removesuffix(".")
    return text if unit in {"", "1"} else f"{text} {unit}"


def _base(unit: str) -> tuple[str, float]:
    """The SI unit of a unit's dimension and its factor; a unit that is not known is its own."""
    try:
        return in_base(unit)
    except UnitError:
        return unit, 1.0


def _scalar(node: ast.expr, window: Window) -> Any:
    if isinstance(node, ast.Constant):
        return float(node.value)  # type: ignore[arg-type]
    if isinstance(node, ast.UnaryOp):
        return _signed(node, _scalar(node.operand, window))
    if isinstance(node, ast.BinOp):
        return _combined(node, _scalar(node.left, window), _scalar(node.right, window))
    assert isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    series = [_series(argument, window) for argument in node.args]
    return window.reduced(node.func.id, series)


def _series(node: ast.expr, window: Window) -> Any:
    name = variable_of(node)
    if name is not None:
        return window.series(name)
    if isinstance(node, ast.UnaryOp):
        return _signed(node, _series(node.operand, window))
    if isinstance(node, ast.BinOp):
        return _combined(node, _series(node.left, window), _series(node.right, window))
    return float(_scalar(node, window))


def _signed(node: ast.UnaryOp, value: Any) -> Any:
    return -value if isinstance(node.op, ast.USub) else value


def _combined(node: ast.BinOp, left: Any, right: Any) -> Any:
    match node.op:
        case ast.Add():
            return left + right
        case ast.Sub():
            return left - right
        case ast.Mult():
            return left * right
        case ast.Div():
            return left / right
    return left**right
