"""`resilin compare`: two results side by side."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import common
from .command_list import RESULTS

if TYPE_CHECKING:
    from rich.table import Table

    from ..results.comparison import Comparison


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("compare", rich_help_panel=RESULTS)(compare)


def compare(
    one: Annotated[Path, typer.Argument(help="A result, at whose times the two are compared.")],
    other: Annotated[Path, typer.Argument(help="The result to compare with it.")],
    variables: common.Variables = None,
    output: Annotated[
        Path | None, typer.Option(help="Plot of both over each other, as .png, .svg or .pdf.")
    ] = None,
    json: common.Json = False,
) -> None:
    """Compare two runs: their metrics, then each variable.

    Example: resilin compare results/flapping-full-wings.nc results/slower.nc
    """
    from ..report.image import check_plot
    from ..results.comparison import compared
    from ..results.plot import overlay
    from ..results.recorded import read_recorded

    with common.reported():
        if output is not None:
            check_plot(output)
        names = common.run_names([one, other])
        runs = {name: read_recorded(path) for name, path in names.items()}
        found = compared(*runs.values(), patterns=variables)
        if output is not None:
            overlay(runs, output, variables)
    if json:
        common.print_json(_facts(found, names))
        return
    from rich.text import Text

    console = common.console()
    for table in _tables(found, list(names)):
        console.print(table)
    for name, lacking in zip(names, found.missing, strict=True):
        if lacking:
            console.print(Text(f"not in {name}: {', '.join(lacking)}"))
    if output is not None:
        typer.echo(f"plot: {output}")


def _tables(found: Comparison, names: list[str]) -> list[Table]:
    """Metrics beside each other, and the differences of the variables that both have."""
    from rich.table import Table

    from ..errors import printable

    metrics = Table("metric", *map(printable, names), "change", title="metrics")
    for pair in found.metrics:
        values = [metric.shown if metric else "-" for metric in (pair.one, pair.other)]
        change = f"{100.0 * pair.change:+.3g} %" if isfinite(pair.change) else "-"
        metrics.add_row(printable(pair.name), *values, change)
    differences = Table(
        title=f"{printable(names[1])} minus {printable(names[0])},"
        f" {found.begin:.4g} to {found.end:.4g} s"
    )
    differences.add_column("variable", overflow="fold")
    for heading in ("largest", "relative", "at", "rms"):
        differences.add_column(heading, justify="right", no_wrap=True)
    for each in found.differences:
        unit = "" if each.unit in {"", "1"} else f" {printable(each.unit)}"
        differences.add_row(
            printable(each.name), f"{each.largest:.3g}{unit}",
            f"{each.relative:.2g}" if isfinite(each.relative) else "-",
            f"{each.at:.4g} s", f"{each.rms:.3g}{unit}",
        )  # fmt: skip
    for column in metrics.columns[1:]:
        column.justify = "right"
    return [table for table in (metrics, differences) if table.row_count]


def _facts(found: Comparison, names: dict[str, Path]) -> dict[str, Any]:
    """The comparison as data for scripts: values in SI."""
    return {
        "results": list(map(str, names.values())),
        "begin": found.begin,
        "end": found.end,
        "metrics": {
            pair.name: {
                "values": [m.value if m else None for m in (pair.one, pair.other)],
                "unit": next(m.unit for m in (pair.one, pair.other) if m),
                "change": pair.change,
            }
            for pair in found.metrics
        },
        "differences": {
            each.name: {
                "unit": each.unit,
                "largest": each.largest,
                "at": each.at,
                "rms": each.rms,
                "relative": each.relative,
            }
            for each in found.differences
        },
        "missing": dict(zip(names, found.missing, strict=True)),
    }
