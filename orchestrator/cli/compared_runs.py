"""What `resilin compare` shows of two runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

from ..results.comparison import Comparison, SettingPairs
from ..results.recorded import Recorded

if TYPE_CHECKING:
    from rich.table import Table

    from ..results.comparison import Difference
    from ..studies.sweep.comparison import MetricDifference

MOST_SETTINGS = 20
"""Settings that a table shows."""


def tables(found: Comparison, names: Sequence[str]) -> list[Table]:
    """Metrics beside each other, and the differences of the variables that both have."""
    from rich.table import Table

    from ..errors import printable
    from ..report.whole_names import keep_whole

    metrics = Table("metric", *map(printable, names), "change", title="metrics")
    for pair in found.metrics:
        values = [metric.shown if metric else "-" for metric in (pair.one, pair.other)]
        change = f"{100.0 * pair.change:+.3g} %" if isfinite(pair.change) else "-"
        metrics.add_row(printable(pair.name), *values, change)
    differences = Table(
        title=f"{printable(names[1])} minus {printable(names[0])},"
        f" {found.begin:.4g} to {found.end:.4g} s"
    )
    differences.add_column("variable")
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
    texts = Table("text", title=f"texts, {found.begin:.4g} to {found.end:.4g} s")
    for heading in ("differs for", "first at"):
        texts.add_column(heading, justify="right", no_wrap=True)
    for heading in map(printable, names):
        texts.add_column(heading)
    for text in found.texts:
        told = [
            f"{text.apart:.4g} s", f"{text.first:.4g} s",
            *(printable(repr(each), most=40) for each in (text.ours, text.theirs)),
        ]  # fmt: skip
        texts.add_row(
            printable(text.name), *(told if isfinite(text.first) else ["0 s", "-", "-", "-"])
        )
    return [keep_whole(table, 0) for table in (metrics, differences, texts) if table.row_count]


def settings_table(found: SettingPairs, names: Sequence[str]) -> Iterator[Table | str]:
    """What the two were run with that is not alike."""
    from rich.table import Table

    from ..errors import printable

    if not found:
        return
    shown = Table(title="settings that differ")
    for heading in ("setting", *map(printable, names)):
        shown.add_column(heading, overflow="fold")
    for name, pair in list(found.items())[:MOST_SETTINGS]:
        shown.add_row(printable(name), *("-" if text is None else text for text in pair))
    yield shown
    if len(found) > MOST_SETTINGS:
        yield f"and {len(found) - MOST_SETTINGS} more settings: --json shows all"


def remarks(runs: Mapping[str, Recorded]) -> Iterator[str]:
    """What to know of each run before its numbers are compared."""
    for name, run in runs.items():
        if run.notes.verdict:
            yield f"{name}: NOT TO BE USED: {run.notes.verdict}"
        yield from (f"{name}: warning: {text}" for text in run.notes.warnings)
        yield from (f"{name}: dropped: {text}" for text in run.notes.dropped)


def difference_facts(each: Difference | MetricDifference) -> dict[str, Any]:
    """The difference of a variable between runs, or of a metric between sweeps, for scripts."""
    return {
        "unit": each.unit,
        "largest": each.largest,
        "at": each.at,
        "rms": each.rms,
        "relative": each.relative,
    }


def facts(found: Comparison) -> dict[str, Any]:
    """The comparison as data for scripts: values in SI."""
    return {
        "settings": found.settings,
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
        "differences": {each.name: difference_facts(each) for each in found.differences},
        "texts": {
            text.name: {"apart": text.apart, "first": text.first, "then": [text.ours, text.theirs]}
            for text in found.texts
        },
    }
