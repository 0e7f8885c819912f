"""What is reported of a run beside its metrics: estimated errors, energies, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import printable
from ..report.whole_names import keep_whole
from .accuracy import INACCURATE, MEANINGLESS, largest_error, remedy, still
from .outcome import Outcome
from .run_warning import RunWarning

if TYPE_CHECKING:
    from rich.table import Table

LIMIT = 0.01
"""Share of the energy exchanged above which a coupling is worth a warning."""
MOST_FINDINGS = 3
"""Findings of one FMU that a run shows."""
LEAST_ROWS = 10
"""Rows from which outputs that stand still are noticed."""


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
    return keep_whole(table, 0)


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
    return keep_whole(table, 0)


def warnings(outcome: Outcome) -> Iterator[RunWarning]:
    """What a user should know before trusting the numbers."""
    for name, travel in still(outcome).items():
        text = f"does not move ({travel:.1g} peak to peak): is it driven, and do forces cancel?"
        yield RunWarning("still", name, text, travel)
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
            "estimated error", name, f"{text}; {remedy(outcome.plan, relative)}", relative
        )
    for place, text in outcome.unseen.items():
        yield RunWarning("not estimated", place, text)
    if outcome.doubt:
        yield RunWarning("no estimate", "no error estimate", outcome.doubt)
    for name, report in outcome.reports.items():
        if report.warned:
            cause = f": {report.warning}" if report.warning else ", without a text"
            text = f"{report.warned} of its steps came back with a warning{cause}"
            yield RunWarning("instance", name, text)
    yield from _descriptions(outcome)
    for name in _silent(outcome):
        text = (
            "its outputs jump in the first step and never change again; if it integrates up to the"
            " stop time at once, stop_time = false keeps that from it"
        )
        yield RunWarning("fmu", name, text)


def _descriptions(outcome: Outcome) -> Iterator[RunWarning]:
    """What was read past in each FMU: its first findings, and where the others are."""
    seen: set[Path] = set()
    for name, interface in outcome.plan.interfaces.items():
        if interface.path in seen:
            continue
        seen.add(interface.path)
        for warning in interface.warnings[:MOST_FINDINGS]:
            yield RunWarning("fmu", name, warning)
        if (left := len(interface.warnings) - MOST_FINDINGS) > 0:
            yield RunWarning("fmu", name, f"{left} more: resilin check {interface.path}")


def _silent(outcome: Outcome) -> Iterator[str]:
    """FMUs that know the stop time and whose real outputs change in the first step alone."""
    rows = outcome.rows
    if not LEAST_ROWS <= len(rows) == outcome.kept:
        return
    plan = outcome.plan
    for name, component in plan.scenario.components.items():
        if plan.interfaces[name].ours or not component.stop_time:
            continue
        columns = [
            k
            for k, (owner, v) in enumerate(plan.records)
            if owner == name and v.real and v.causality == "output"
        ]
        own = rows[:, columns]
        if (own[0] != own[1]).any() and (own[1:] == own[1]).all():
            yield name
