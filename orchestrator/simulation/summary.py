"""What is reported of a run beside its metrics: estimated errors, energies, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, log10
from typing import TYPE_CHECKING

import numpy as np

from ..errors import printable
from ..results.outcome import Outcome
from ..results.run_warning import RunWarning
from ..scenario.plan import Plan, usual
from ..scenario.schema import PerCycle
from ..units import UnitError, in_base
from .energy_audit import LIMIT

if TYPE_CHECKING:
    from rich.table import Table


INACCURATE = 0.01
"""Estimated error of a leading variable, by its largest value, from which on a run warns."""
MARGIN = 0.7
"""Share of it that the step aims at which a warning names."""
MEANINGLESS = 0.5
"""The same from which on the numbers of a run say nothing."""
STILL = 1e-9
"""Travel [m] or [rad] of a leading variable up to which it does not move."""
FROZEN_ROWS = 10
"""Rows from which on outputs that no longer change are worth a word."""
NONE_SEEN = 1e-12
"""The same below which only rounding is left."""


def largest_error(outcome: Outcome) -> tuple[str, float]:
    """The leading variable with the largest estimated relative error, and that error.

    "" and 0 where nothing is estimated.
    """
    estimates = outcome.estimates or {}
    found = {name: estimates[name].relative for name in outcome.plan.leading if name in estimates}
    return max(found.items(), key=lambda entry: entry[1], default=("", 0.0))


def accuracy(outcome: Outcome) -> str:
    """One line on the estimated error of a run, "" where there is none."""
    name, relative = largest_error(outcome)
    if not name:
        return ""
    covers = "of the coupling, by a second run at half the step"
    if relative < NONE_SEEN:
        return f"estimated error: none seen, {covers}"
    return f"estimated error: {relative:.1e} of the largest {printable(name)}; {covers}"


def meaningless(outcome: Outcome) -> str:
    """Why the numbers of a run say nothing, "" where they do."""
    name, relative = largest_error(outcome)
    if relative < MEANINGLESS or name in _still(outcome):
        return ""
    return (
        f"{name}: estimated error {relative:.0%} of its largest value, these numbers say nothing;"
        f" {_remedy(outcome.plan, relative)}"
    )


def _remedy(plan: Plan, relative: float) -> str:
    """The setting that would bring the error of a leading variable below `INACCURATE`."""
    if relative >= MEANINGLESS:
        return 'lower the step by far, or let step = "auto" find one'
    first = plan.scenario.master.laws == "held" or usual(plan.connections) == "extrapolated"
    share = (MARGIN * INACCURATE / relative) ** (1.0 if first else 0.5)
    time = plan.scenario.time
    if time.tolerance is not None:
        return f"--tolerance {_rounded_down(share**2 * time.tolerance):g} would do"
    if isinstance(time.step, PerCycle):
        return f'--step "{_rounded_up(time.step.per_cycle / share)} per cycle" would do'
    return f'--step "{_rounded_down(plan.grid.step * share):g} s" would do'


def _still(outcome: Outcome) -> dict[str, float]:
    """Leading displacements and angles that stay where they are, with their travel in SI."""
    found = {}
    for name, variable in ((f"{c}.{v.name}", v) for c, v in outcome.plan.records):
        try:
            unit, scale = in_base(variable.unit)
        except UnitError:
            continue
        if name not in outcome.plan.leading or unit not in {"m", "rad"} or not len(outcome.rows):
            continue
        travel = scale * float(np.ptp(outcome.series(name)))
        if travel < STILL:
            found[name] = travel
    return found


def _frozen(outcome: Outcome) -> Iterator[str]:
    """Foreign instances whose recorded outputs change once, at the first step."""
    places: dict[str, list[int]] = {}
    for k, (component, _) in enumerate(outcome.plan.records):
        if not outcome.plan.interfaces[component].ours:
            places.setdefault(component, []).append(k)
    for component, columns in places.items():
        rows = outcome.rows[:, columns]
        if len(rows) < FROZEN_ROWS or outcome.kept > len(rows):
            continue
        if (rows[0] != rows[1]).any() and (rows[1:] == rows[1]).all():
            yield component


def _rounded_down(value: float) -> float:
    """The next number below that has two digits."""
    unit = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{floor(value / unit) * unit:.2g}")


def _rounded_up(count: float) -> int:
    """The next whole number above that has two digits."""
    unit = int(10 ** max(floor(log10(count)) - 1, 0))
    return ceil(count / unit) * unit


def errors(outcome: Outcome) -> Table:
    """Estimated error of each coupling value: those that are wired and not members of laws."""
    from rich.table import Table

    plan = outcome.plan
    wired = {f"{c.source}.{c.output.name}" for c in plan.connections if not c.output.order}
    units = {f"{name}.{v.name}": v.unit for name, v in plan.records}
    table = Table("coupling value", "estimated error", "of its largest", title="accuracy")
    named = sorted(wired & set(outcome.estimates or {})) or sorted(outcome.estimates or {})
    for name in named:
        found = (outcome.estimates or {})[name]
        table.add_row(printable(name), f"{found.error:.2g} {units[name]}", f"{found.relative:.1e}")
    return table


def couplings(outcome: Outcome) -> Table:
    """Energy that each power coupling has created or lost, and its share of the exchanged."""
    from rich.table import Table

    frequency = outcome.plan.frequency
    cycles = outcome.simulated * frequency if frequency else 1.0
    each = "a cycle" if frequency else "in all"
    table = Table("coupling", f"created {each}", "of the exchanged", title="energy of couplings")
    for name, (created, exchanged) in outcome.couplings.items():
        share = created / exchanged if exchanged else 0.0
        table.add_row(printable(name), f"{created / cycles:+.2e} J", f"{share:+.1e}")
    return table


def warnings(outcome: Outcome) -> Iterator[RunWarning]:
    """What a user should know before trusting the numbers."""
    for name, travel in _still(outcome).items():
        text = f"does not move ({travel:.1g} peak to peak): is it driven, and do forces cancel?"
        yield RunWarning("still", name, text, travel)
    for name in _frozen(outcome):
        text = "its outputs change in the first step and never again: has it run ahead to the end?"
        yield RunWarning("still", name, text)
    for name, (created, exchanged) in outcome.couplings.items():
        if exchanged and abs(created) > LIMIT * exchanged:
            share = created / exchanged
            verb = "creates" if share > 0.0 else "loses"
            text = (
                f"{verb} {abs(share):.1%} of the energy that it exchanges;"
                " lower the step or connect whole ports"
            )
            yield RunWarning("coupling energy", name, text, share)
    name, relative = largest_error(outcome)
    if INACCURATE < relative < MEANINGLESS:
        text = f"has an estimated error of {relative:.1%} of its largest value"
        yield RunWarning(
            "estimated error", name, f"{text}; {_remedy(outcome.plan, relative)}", relative
        )
    for place, text in outcome.unseen.items():
        yield RunWarning("not estimated", place, text)
    if outcome.doubt:
        yield RunWarning("no estimate", "no error estimate", outcome.doubt)
    for name, report in outcome.reports.items():
        if report.warned:
            said = f": {report.warning}" if report.warning else ", without a text"
            text = f"{report.warned} of its steps came back with a warning{said}"
            yield RunWarning("instance", name, text)
    for name, interface in outcome.plan.interfaces.items():
        for warning in interface.warnings[:1]:
            yield RunWarning("fmu", name, warning)
