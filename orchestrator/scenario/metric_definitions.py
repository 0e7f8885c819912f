"""The metrics of a scenario checked against its FMUs: expressions, variables, units."""

from __future__ import annotations

from ..errors import Problems, nearest, printable
from ..fmi.description import Interface
from ..units import UnitError
from .metric_expression import expression_of, unit_of
from .schema import Scenario


def check_metrics(scenario: Scenario, interfaces: dict[str, Interface], problems: Problems) -> None:
    """Note each metric that cannot be read, or names a variable that does not exist."""
    variables = {
        f"{name}.{variable.name}": variable
        for name, interface in interfaces.items()
        for variable in interface.variables.values()
    }
    units = {name: variable.unit for name, variable in variables.items()}
    outputs = [f"{c}.{v.name}" for c, i in interfaces.items() for v in i.of("output")]
    for name, text in scenario.metrics.defined.items():
        key = f"metrics.{printable(name)}"
        try:
            expression = expression_of(text)
            for variable in expression.variables:
                if variable not in units:
                    hint = nearest(variable, outputs)
                    raise ValueError(f"no output {printable(variable)!r}; {hint}")
                if not variables[variable].numeric:
                    kind = variables[variable].kind
                    raise ValueError(f"{printable(variable)} is a {kind}; metrics are of numbers")
            unit_of(expression, units)
        except (ValueError, UnitError) as error:
            problems.add(key, error)
