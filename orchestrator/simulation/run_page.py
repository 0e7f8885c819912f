"""A run as a page: metrics with errors, plots, the diagram, accuracy, what it was made of."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Sequence
from math import isnan
from pathlib import Path

from ..errors import printable
from ..report.page import Notes, Page, Part, Section, Words
from ..report.picture import Picture
from ..report.plot import Axis, Curve, Figure, Plot
from ..report.table import Cell, Column, Table, quantity
from ..results.accuracy import accuracy
from ..results.card import metrics_table, pace
from ..results.metrics import Metric, left_out
from ..results.netcdf import provenance, release
from ..results.outcome import Outcome
from ..results.plot import CYCLES, panels_of
from ..results.recorded import Recorded
from ..results.run_notes import RunNotes, notes_of
from ..scenario.plan import Plan

LONGEST = 300
"""Characters of a foreign text that a page shows."""


def page(outcome: Outcome, data: Recorded, metrics: Sequence[Metric]) -> Page:
    """The report of a whole run; `data` are its recorded series."""
    plan = outcome.plan
    notes = notes_of(outcome)
    sections = [
        Section("trust", "Before trusting the numbers", _listed(notes.warnings)),
        Section("dropped", "What the scenario has lost", _listed(notes.dropped)),
        Section("metrics", "Metrics", list(_metrics(outcome, data, metrics))),
        Section("plots", "Plots", list(_plots(data))),
        Section("system", "System", [_diagram(plan), _components(outcome)]),
        Section("accuracy", "Accuracy", list(_accuracy(outcome))),
        Section("made-of", "What it was made of", [_starts(plan), _provenance(plan)]),
    ]
    facts = [
        ("Resilin", release()),
        ("Scenario", printable(str(plan.path), most=LONGEST)),
        ("Master", plan.scenario.master.kind),
        ("Laws", plan.scenario.master.laws),
    ]
    title = printable(plan.scenario.title, most=LONGEST) or plan.path.stem
    lead = [f"With {notes.changed}."] * bool(notes.changed) + [f"{pace(outcome)}."]
    shown = [each for each in sections if each.parts]
    return Page(title, " ".join(lead), shown, facts, list(_alarms(notes, metrics)))


def _alarms(notes: RunNotes, found: Sequence[Metric]) -> Iterator[str]:
    """Why the numbers are not to be used."""
    if notes.verdict:
        yield f"Not to be used: {notes.verdict}"
    wrong = [printable(metric.name, most=LONGEST) for metric in found if isnan(metric.value)]
    if wrong:
        yield f"Without a value: {', '.join(wrong)}"


def _listed(texts: Sequence[str]) -> list[Part]:
    return [Notes(texts)] if texts else []


def _metrics(outcome: Outcome, data: Recorded, found: Sequence[Metric]) -> Iterator[Part]:
    if found:
        yield metrics_table(found, errors=outcome.estimates is not None)
    gone = [printable(f"{m.name}: {m.reason}", most=LONGEST) for m in left_out(data)]
    if gone:
        yield Words(("Metrics left out:",))
        yield Notes(gone)


def _plots(data: Recorded) -> Iterator[Part]:
    """The panels of the scenario over the last cycles, one below the other."""
    plots = [
        Plot(
            title=printable(label.partition(" (")[0] or label, most=LONGEST) or "values",
            x=Axis("time (s)"),
            y=Axis(printable(label, most=LONGEST)),
            curves=[
                Curve(printable(name, most=LONGEST), times.tolist(), values.tolist())
                for name, times, values in curves
            ],
        )
        for label, curves in panels_of(data, CYCLES)
    ]
    if plots:
        span = f"The last {CYCLES:g} cycles" if data.frequency else "The whole run"
        yield Figure("run", "Recorded", f"{span}; the pointer shows values.", plots)


def _diagram(plan: Plan) -> Part:
    """The drawing of components and wires, with the wires as its text."""
    from ..scenario.diagram.draw import draw

    with tempfile.TemporaryDirectory(prefix="resilin_page_") as folder:
        drawn = draw(plan, Path(folder) / "diagram.svg").read_bytes()
    wires = [f"{c.source}.{c.output.name} to {c.target}.{c.input.name}" for c in plan.connections]
    shown = printable("; ".join(wires), most=2000) or "no wires"
    return Picture("Components in the order in which they step", f"Wires: {shown}", drawn)


def _components(outcome: Outcome) -> Table:
    columns = [
        Column("Component"), Column("FMU"), Column("Runs"), Column("Steps", number=True),
        Column("Rollbacks", number=True),
    ]  # fmt: skip
    rows = []
    for name, interface in outcome.plan.interfaces.items():
        kind = "compiled" if not interface.needs_tool else "in Python"
        place = kind if interface.ours else "guarded, as it is foreign"
        calls, back = outcome.calls.get(name, 0), outcome.rollbacks.get(name, 0)
        file = printable(interface.path.name, most=LONGEST)
        rows.append(
            [Cell(printable(name)), Cell(file), Cell(place), quantity(calls, f"{calls}"),
             quantity(back, f"{back}")]
        )  # fmt: skip
    return Table("Components", columns, rows)


def _accuracy(outcome: Outcome) -> Iterator[Part]:
    told = [text for text in (accuracy(outcome), outcome.plan.step_reason, outcome.doubt) if text]
    if told:
        yield Words(tuple(printable(text, most=LONGEST) for text in told))
    if outcome.estimates:
        units = {f"{name}.{v.name}": v.unit for name, v in outcome.plan.records}
        rows = []
        for name, found in sorted(outcome.estimates.items()):
            unit = printable(units.get(name, ""))
            shown = f"{found.error:.2g} {unit}".removesuffix(" 1").strip()
            rows.append(
                [Cell(printable(name, most=LONGEST)), quantity(found.error, shown),
                 quantity(found.relative, f"{found.relative:.1e}")]
            )  # fmt: skip
        columns = [
            Column("Variable"), Column("Error", number=True),
            Column("Of its largest", number=True),
        ]  # fmt: skip
        yield Table("Estimated errors, by half the step", columns, rows)
    if outcome.couplings:
        rows = []
        for name, (created, exchanged) in outcome.couplings.items():
            share = created / exchanged if exchanged else 0.0
            rows.append(
                [Cell(printable(name, most=LONGEST)), quantity(abs(created), f"{created:+.2e} J"),
                 quantity(exchanged, f"{exchanged:.2e} J"), quantity(abs(share), f"{share:+.1e}")]
            )  # fmt: skip
        columns = [
            Column("Coupling"), Column("Created", number=True), Column("Exchanged", number=True),
            Column("Share", number=True),
        ]  # fmt: skip
        yield Table("Energy that the couplings have created", columns, rows)


def _starts(plan: Plan) -> Table:
    """What the scenario sets; all else stands as the FMUs have it."""
    rows = []
    for component, values in plan.starts.items():
        known = plan.interfaces[component].variables
        for name, value in values.items():
            shown = f"{value:.6g}" if isinstance(value, float) else str(value)
            variable = known.get(name)
            if variable is not None and variable.choices and float(value) in variable.codes:
                shown = variable.choices[variable.codes.index(int(float(value)))]
            elif variable is not None and variable.unit not in {"", "1"}:
                shown = f"{shown} {variable.unit}"
            cells = (f"{component}.{name}", shown)
            rows.append([Cell(printable(text, most=LONGEST)) for text in cells])
    columns = [Column("Variable"), Column("Value")]
    return Table("Start values that the scenario sets, in SI", columns, rows)


def _provenance(plan: Plan) -> Table:
    found = provenance(plan)
    digests = json.loads(found["fmu_sha256"])
    rows = [
        [Cell("communication step"), Cell(f"{plan.grid.step:.6g} s")],
        *(
            [Cell(f"SHA-256 of {printable(name)}"), Cell(printable(str(digest)))]
            for name, digest in digests.items()
        ),
    ]
    return Table("Provenance", [Column("What"), Column("Value")], rows)
