"""`resilin run`: a scenario from start to stop, its result, its plot, its metrics."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import common
from .command_list import RUNS

if TYPE_CHECKING:
    from rich.console import Console

    from ..results.metrics import LeftOut, Metric
    from ..results.outcome import Outcome
    from ..results.recorded import Recorded

MOST_LOST = 2
"""Metrics left out that have a line each."""


def add_to(app: typer.Typer) -> None:
    """Register the commands."""
    app.command("run", rich_help_panel=RUNS)(run)
    app.command("recover", rich_help_panel=RUNS)(recover)


def run(
    scenario: common.ScenarioName,
    output: Annotated[
        Path | None, typer.Option(help="Result file; results/SCENARIO.nc if not given.")
    ] = None,
    name: common.Name = None,
    set_: common.Sets = None,
    laws: common.Laws = None,
    kind: common.Kind = None,
    stop: common.Stop = None,
    step: common.Step = None,
    tolerance: common.Tolerance = None,
    estimate: Annotated[
        bool | None,
        typer.Option(
            help="Run again at half the step to estimate the error; if neither, of quick runs."
        ),
    ] = None,
    fmus: common.Library = common.BUILT,
    native: common.Native = None,
    picture: common.Picture = True,
    html: common.Html = None,
    json: common.Json = False,
    quiet: common.Quiet = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Print calls, energies and messages too.")
    ] = False,
) -> None:
    """Run a scenario: its result, a picture and its metrics.

    A result of the same name but of other settings is kept, under a name with its digest.

    \b
    Example: resilin run flapping-full-wings --set amplifier.frequency="20 Hz"
    """
    from ..report.page import check_page
    from ..results.accuracy import meaningless
    from ..results.kept_aside import keep_other
    from ..results.netcdf import (
        check_target,
        partial_path,
        prepare,
        provenance,
        segments_for,
        write,
    )
    from ..simulation.interrupt import Interrupt
    from ..simulation.load import load
    from ..simulation.run import run as run_plan

    with Interrupt() as interrupt, common.reported():
        target = common.result_path(scenario, output, name)
        options = common.overrides(laws, kind, stop, step, tolerance)
        parts = common.library(fmus, native, scenario)
        check_target(target)
        if html is not None:
            check_page(html)
        plan = load(scenario, common.assignments(set_), parts, **options)
        prepare(target)
        interrupt.check()
        if output is None:
            keep_other(target, provenance(plan))
        progress = not (quiet or json) and sys.stderr.isatty()
        outcome = run_plan(
            plan,
            progress=progress,
            interrupt=interrupt,
            segments=segments_for(plan, target),
            estimate=estimate,
        )
        with interrupt.withheld():
            written = write(outcome, target)
    if outcome.failure is not None:
        kept = f"{outcome.kept} rows are kept in {partial_path(target)}"
        if target.exists():
            kept += f"; {target} is still the result of an earlier run"
        common.fail(f"{outcome.failure}; {kept}", getattr(outcome.failure, "exit_code", 1))
    report = _page(outcome, written, html) if html is not None else None
    _show(outcome, written, report, plot=picture, json=json, quiet=quiet, verbose=verbose)
    reason = meaningless(outcome)
    if reason:
        common.fail(f"{reason}; {written} is whole", 1)


def recover(
    folder: Annotated[Path, typer.Argument(help="NAME.segments, as a killed run leaves it.")],
) -> None:
    """Make a partial result of what a killed run had written.

    \b
    Example: resilin recover results/oscillator-1.segments
    """
    from ..results.netcdf import recover as recovered

    with common.reported():
        path, rows, lost = recovered(folder)
    typer.echo(f"{rows} rows: {path}")
    if lost:
        common.fail(f"{folder}: damaged, their rows are lost: {', '.join(lost)}", 1)


def _page(outcome: Outcome, written: Path, path: Path) -> Path:
    """Write the report of a run as a page."""
    from ..errors import OutputError
    from ..report.page import write
    from ..results.metrics import metrics
    from ..results.recorded import read_recorded, recorded
    from ..simulation.run_page import page

    data = read_recorded(written) if outcome.segments else recorded(outcome)
    try:
        return write(page(outcome, data, metrics(data)), path)
    except OutputError as error:
        common.fail(f"{error}; {written} is whole", 2)
    return path


def _show(
    outcome: Outcome,
    written: Path,
    report: Path | None,
    *,
    plot: bool,
    json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Plot and print a run, from the file that it has written."""
    from ..results.metrics import left_out, metrics
    from ..results.recorded import read_recorded, recorded

    drawn: Path | None = None
    data = read_recorded(written) if outcome.segments else recorded(outcome)
    if plot and data.series:
        drawn = _drawn(data, written)
    if quiet:
        return
    found, gone = metrics(data), left_out(data)
    if json:
        facts = _facts(outcome, found, gone, written, drawn)
        common.print_json(facts | {"page": str(report) if report else None})
        _check_numbers(found)
        return
    try:
        _report(outcome, found, gone, written, drawn, report, verbose)
    except OSError as error:
        common.fail(f"standard output: {error.strerror}; {written} is whole", 1)
    _check_numbers(found)


def _check_numbers(found: Sequence[Metric]) -> None:
    """End with an error where a metric is not a number; the result itself is whole."""
    wrong = [f"metrics.{metric.name}: {metric.shown}" for metric in found if isnan(metric.value)]
    if wrong:
        common.fail("\n".join(wrong), 1)


def _drawn(data: Recorded, written: Path) -> Path | None:
    from ..errors import OutputError
    from ..results.plot import draw

    path = written.with_suffix(".png")
    try:
        return draw(data, path)
    except OutputError as error:
        common.fail(f"{error}; {written} is whole", 2)
    return None


def _facts(
    outcome: Outcome,
    found: Sequence[Metric],
    gone: Sequence[LeftOut],
    written: Path,
    drawn: Path | None,
) -> dict[str, Any]:
    """The report of a run as data for scripts."""
    from ..results.run_notes import notes_of

    estimates = outcome.estimates or {}
    return {
        "title": outcome.plan.scenario.title,
        "step_reason": outcome.plan.step_reason,
        "advice": outcome.plan.step_reason,  # the old name, for one release
        "result": str(written),
        "picture": str(drawn) if drawn else None,
        "metrics": {m.name: {"value": m.value, "unit": m.unit, "error": m.error} for m in found},
        "metrics_left_out": {each.name: each.reason for each in gone},
        "communication_steps": outcome.steps,
        "rejected_steps": outcome.rejected,
        "step_calls": outcome.calls,
        "rollbacks": outcome.rollbacks,
        "wall_time": outcome.wall_time,
        "simulated": outcome.simulated,
        "estimated_error": {name: e.error for name, e in estimates.items()},
        "estimated_relative_error": {name: e.relative for name, e in estimates.items()},
        "no_estimate": outcome.doubt,
        "not_estimated": outcome.unseen,
        **asdict(notes_of(outcome)),
        "coupling_energies": {
            name: {"created": created, "exchanged": exchanged}
            for name, (created, exchanged) in outcome.couplings.items()
        },
    }


def _lost(gone: Sequence[LeftOut]) -> list[str]:
    """Lines on the metrics that are left out: one for all where there are many."""
    from ..errors import printable

    if len(gone) > MOST_LOST:
        names = ", ".join(printable(each.name) for each in gone)
        return [f"metrics left out: {names}; resilin inspect says why"]
    return [
        f"metric left out: {printable(each.name)}: {printable(each.reason, most=900)}"
        for each in gone
    ]


def _report(
    outcome: Outcome,
    found: Sequence[Metric],
    gone: Sequence[LeftOut],
    written: Path,
    drawn: Path | None,
    report: Path | None,
    verbose: bool,
) -> None:
    """Print the table of metrics, the warnings, and where the files are."""
    from rich.table import Table
    from rich.text import Text

    from ..errors import printable
    from ..report.whole_names import keep_whole
    from ..results.accuracy import accuracy
    from ..results.run_notes import notes_of

    console = common.console()
    notes = notes_of(outcome)
    named = [printable(outcome.plan.scenario.title)]
    named += [f"with {notes.changed}"] * bool(notes.changed)
    title = Text("\n".join(named))
    table = Table(title=title, title_justify="left")
    table.add_column("metric")
    table.add_column("value", justify="right")
    if outcome.estimates is not None:
        table.add_column("estimated error", justify="right")
    for metric in found:
        row = [printable(metric.name), printable(metric.shown), printable(metric.shown_error)]
        table.add_row(*row[: len(table.columns)])
    console.print(keep_whole(table, 0) if found else title)
    compiled = [n for n, i in outcome.plan.interfaces.items() if i.ours and not i.needs_tool]
    speed = outcome.simulated / outcome.wall_time
    rejected = f" and {outcome.rejected} rejected" if outcome.rejected else ""
    console.print(
        f"{outcome.steps} communication steps{rejected} by {outcome.plan.scenario.master.kind},"
        f" {outcome.simulated:.3f} s simulated in {outcome.wall_time:.2f} s,"
        f" {speed:.1f} times real time",
        highlight=False,
        soft_wrap=True,
    )
    if compiled:
        console.print(f"compiled parts: {', '.join(compiled)} (--python for the others)")
    if outcome.plan.step_reason:
        console.print(f"auto: {outcome.plan.step_reason}", highlight=False)
    if stated := accuracy(outcome):
        console.print(stated, highlight=False, soft_wrap=True)
    if verbose:
        _print_details(console, outcome)
    for text in _lost(gone):
        console.print(Text(text), soft_wrap=True)
    for dropped in notes.dropped:
        console.print(Text(f"dropped: {printable(dropped, most=200)}"), soft_wrap=True)
    for line in notes.warnings:
        console.print(Text(f"warning: {line}"), soft_wrap=True)
    for label, path in (("result:", written), ("plot:  ", drawn), ("page:  ", report)):
        if path is not None:
            shown = Text(f"{label} {printable(str(path), most=1000)}")
            console.print(shown, soft_wrap=True)


def _print_details(console: Console, outcome: Outcome) -> None:
    """Print errors, energies, calls and messages of each instance, and how the loop ran."""
    from rich.text import Text

    from ..results.summary import couplings, errors

    if outcome.estimates is not None:
        console.print(errors(outcome))
    console.print(couplings(outcome))
    for name, count in outcome.calls.items():
        back = outcome.rollbacks.get(name, 0)
        console.print(f"{name}: {count} steps, {back} rollbacks", highlight=False)
    for name, report in outcome.reports.items():
        for message in report.messages:
            console.print(Text(f"{name}: {message}"), soft_wrap=True)
    loop = f"in Python: {outcome.python_loop}" if outcome.python_loop else "compiled"
    console.print(f"communication loop {loop}", highlight=False)
    console.print(f"residual at the start: {outcome.residual:.2g}", highlight=False)
