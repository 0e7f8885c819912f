"""What is reported of a run beside its metrics: estimated errors, energies, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..errors import printable
from ..results.outcome import Outcome
from ..results.run_warning import RunWarning
from .energy_audit import LIMIT

if TYPE_CHECKING:
    from rich.table import Table


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
    for name, (created, exchanged) in outcome.couplings.items():
        if exchanged and abs(created) > LIMIT * exchanged:
            share = created / exchanged
            verb = "creates" if share > 0.0 else "loses"
            text = (
                f"{verb} {abs(share):.1%} of the energy that it exchanges;"
                " lower the step or connect whole ports"
            )
            yield RunWarning("coupling energy", name, text, share)
    if outcome.doubt:
        yield RunWarning("no estimate", "no error estimate", outcome.doubt)
    for name, interface in outcome.plan.interfaces.items():
        for warning in interface.warnings[:1]:
            yield RunWarning("fmu", name, warning)
