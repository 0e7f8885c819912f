"""An outcome as a card for a notebook: how the run went, its metrics, what was recorded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..errors import printable
from ..report.notebook import LONGEST, Card
from ..report.table import Cell, Column, Table, quantity
from .metrics import Metric, left_out, metrics
from .outcome import Outcome
from .run_notes import notes_of


def card(outcome: Outcome) -> Card:
    """Metrics over the last cycles; the recorded variables are folded away."""
    plan = outcome.plan
    title = printable(plan.scenario.title) or plan.path.stem
    return Card(title, list(_lines(outcome)), list(_metrics(outcome)), [_recorded(outcome)])


def _lines(outcome: Outcome) -> Iterator[str]:
    if outcome.failure is not None:
        yield f"stopped: {printable(str(outcome.failure), most=LONGEST)}; {outcome.kept} rows kept"
    notes = notes_of(outcome)
    if notes.changed:
        yield f"with {notes.changed}"
    if notes.verdict:
        yield f"NOT TO BE USED: {notes.verdict}"
    yield pace(outcome)
    yield from (f"warning: {text}" for text in notes.warnings)
    yield from (f"dropped: {text}" for text in notes.dropped)
    for name, changes in outcome.texts.items():
        last = printable(changes[-1][1]) if changes else ""
        yield f"{printable(name)}: {len(changes)} texts, the last {last!r}"
    for left in left_out(outcome) if len(outcome.times) else []:
        yield f"metric left out: {printable(left.name)}: {printable(left.reason, most=LONGEST)}"


def pace(outcome: Outcome) -> str:
    """How many steps a run took, and how fast it was, in one line."""
    rejected = f" and {outcome.rejected} rejected" if outcome.rejected else ""
    speed = outcome.simulated / outcome.wall_time
    return (
        f"{outcome.steps} communication steps{rejected}, {outcome.simulated:.4g} s simulated in"
        f" {outcome.wall_time:.2f} s, {speed:.3g} times real time"
    )


def _metrics(outcome: Outcome) -> Iterator[Table]:
    """The metrics, where there are rows to take them from."""
    found = metrics(outcome) if len(outcome.times) else []
    if found:
        yield metrics_table(found, errors=outcome.estimates is not None)


def metrics_table(found: Sequence[Metric], *, errors: bool) -> Table:
    """Metrics with their values, and with their estimated errors where there are any."""
    columns = [Column("metric"), Column("value", number=True)]
    rows = [[Cell(printable(m.name)), quantity(m.value, printable(m.shown))] for m in found]
    if errors:
        columns.append(Column("estimated error", number=True))
        for row, metric in zip(rows, found, strict=True):
            row.append(Cell(printable(metric.shown_error), metric.error))
    return Table("metrics", columns, rows)


def _recorded(outcome: Outcome) -> Table:
    """Every recorded variable, between what it was, and its estimated error where there is one.

    Of a run that left memory in segments these are the rows that are still there.
    """
    estimates = outcome.estimates
    columns = [
        Column("variable"), Column("unit"), Column("least", number=True),
        Column("greatest", number=True),
    ]  # fmt: skip
    if estimates is not None:
        columns.append(Column("estimated error", number=True))
    rows = []
    for k, (component, variable) in enumerate(outcome.plan.records):
        name, series = f"{component}.{variable.name}", outcome.rows[:, k]
        ends = (series.min(), series.max()) if len(series) else ()
        row = [Cell(printable(name)), Cell(printable(variable.unit))]
        row += [Cell(f"{end:.4g}") for end in ends] or [Cell(""), Cell("")]
        if estimates is not None:
            row.append(Cell(f"{estimates[name].error:.2g}" if name in estimates else ""))
        rows.append(row)
    return Table("recorded variables", columns, rows)
