"""The metrics that runs of a plan can have, and the units in which they are shown."""

from __future__ import annotations

from ...results.metrics import texts_of
from ...scenario.metric_expression import expression_of, unit_of
from ...scenario.plan import Plan


def shown_units(plan: Plan) -> dict[str, str]:
    """Unit in which each metric is shown, by its name, known before anything runs.

    They are those of :func:`orchestrator.results.metrics.metrics`, some of which a run may lack: a
    frequency and a phase of what does not move.
    """
    units = {f"{component}.{variable.name}": variable.unit for component, variable in plan.records}
    texts = texts_of(plan.scenario.metrics.defined, units)
    expressions = {name: expression_of(text) for name, text in texts.items()}
    return {
        name: unit_of(expression, units)
        for name, expression in expressions.items()
        if set(expression.variables) <= set(units)
    }
