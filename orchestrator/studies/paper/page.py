"""A reproduction as a page: the summary on top, then each item with its rows and plots."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ...errors import OutputError
from ...report.files import written_whole
from ...report.page import Fold, Notes, Page, Part, Section, Words
from ...report.plot import Figure
from ...report.table import Cell, Column, Table, Tone, quantity
from .comparison import Comparison, Row
from .published_values import MarkKind
from .reproduction import Reproduction
from .score import score

TONES: dict[MarkKind, Tone] = {
    "predicted": "green",
    "calibrated": "amber",
    "undecidable": "blue",
    "arithmetic": "grey",
}
MEANINGS: dict[MarkKind, str] = {
    "predicted": "nothing of ours was fitted to this number",
    "calibrated": "a parameter of ours was fitted to this number, or chosen with it in sight: its"
    " error says nothing of the model",
    "undecidable": "the text leaves open what was meant; the readings stand side by side",
    "arithmetic": "follows from numbers that the paper prints, whatever the model",
}
VEHICLE = "animation"
LEFT_OUT = (
    "Not here: figure 5, the test of material that gave the constants; curves of the experiments,"
    " which are printed as pictures only."
)
ERRORS = (
    "Relative error is ours over the paper's, less one. Numerical error, in each item's own"
    " table, is that of our stepping (from half the step) or of a peak's place (from the"
    " frequencies beside it). The mark says what an error means:"
)
BANDS = (
    "The band beneath an error is one standard deviation of ours, by the data that were fitted:"
    " 1 Hz of a frequency, 1 % of a stroke, 0.1 mm of a displacement, or by how far the fit misses"
    " them where that is more. It says what the data leave open of the parameters, not what the"
    " model leaves out."
)
LONG = 8
"""Rows from which on a table is folded."""
DRAWN = "drawn.json"
"""Digests of the figures whose pictures stand beside the page."""


def page(found: Reproduction, library: Path) -> Page:
    """The whole report; the vehicle comes first, where it is among the items."""
    items = [Section(item.key, item.title, list(_parts(item))) for item in found.items]
    sections = [
        *(each for each in items if each.key == VEHICLE),
        Section("summary", "Summary", list(_summary(found))),
        *(each for each in items if each.key != VEHICLE),
    ]
    facts = [
        ("Resilin", _release()),
        ("Parts", "compiled" if library.name == "native" else library.name),
        ("Rows", str(sum(len(item.rows) for item in found.items))),
    ]
    lead = (
        "C. Cao, S. Burgess, A. T. Conn: Toward a Dielectric Elastomer Resonator Driven Flapping"
        " Wing Micro Air Vehicle, Frontiers in Robotics and AI, 2019. Its numbers beside those of"
        " co-simulated FMUs, each with what ours rests on."
    )
    return Page("The paper, reproduced", lead, sections, facts)


def pictures(found: Reproduction, folder: Path) -> list[Path]:
    """PNG and SVG of every figure, those drawn again whose curves have changed."""
    from ...report.image import draw

    known = _drawn(folder / DRAWN)
    made: list[Path] = []
    for figure in figures(found):
        paths = [folder / f"{figure.key}{suffix}" for suffix in (".png", ".svg")]
        digest = _digest(figure)
        if known.get(figure.key) != digest or not all(path.is_file() for path in paths):
            known.pop(figure.key, None)
            draw(figure, paths)
            known[figure.key] = digest
        made += paths
    _remember(folder / DRAWN, known)
    return made


def figures(found: Reproduction) -> list[Figure]:
    """All figures of a reproduction."""
    return [figure for item in found.items for figure in item.figures]


def facts(found: Reproduction) -> dict[str, Any]:
    """The same for scripts."""
    return {
        "runs": found.ran,
        "wall_time": found.wall_time,
        "rows": [row.facts() for item in found.items for row in item.rows],
        "failures": found.failures,
        "curves": {figure.key: figure.data() for figure in figures(found)},
        "tables": {
            item.key: _plain(extra)
            for item in found.items
            for extra in item.extras
            if isinstance(extra, Table)
        },
    }


def texts(row: Row) -> tuple[str, str, str]:
    """The paper's value, ours, and the error of ours, as they are shown."""
    stated = row.number
    unit = "" if stated.unit == "1" else f"\N{NO-BREAK SPACE}{stated.unit}"
    paper = stated.value if isinstance(stated.value, str) else f"{stated.value:.4g}{unit}"
    ours = row.ours if isinstance(row.ours, str) else f"{_number(row.ours / stated.scale)}{unit}"
    if row.agrees is not None:
        return paper, ours, "agrees" if row.agrees else "does not agree"
    return (
        paper,
        ours,
        f"{100.0 * row.error:+.1f}\N{NO-BREAK SPACE}%" if math.isfinite(row.error) else "",
    )


def _plain(table: Table) -> list[dict[str, float | str]]:
    """A table for scripts: values where cells have them, else texts."""
    titles = [column.title for column in table.columns]
    cells = [[cell.text if cell.sort is None else cell.sort for cell in row] for row in table.rows]
    return [dict(zip(titles, row, strict=True)) for row in cells]


def _summary(found: Reproduction) -> Iterator[Part]:
    if any(item.rows for item in found.items):
        yield from _scores(found)
    yield Words((LEFT_OUT,))
    if found.failures:
        yield Words(("Runs that stopped, and are left out of curves and peaks:",))
        yield Notes(found.failures)


def _scores(found: Reproduction) -> Iterator[Part]:
    """A line for each item, its numbers behind it; then what the words of a row mean."""
    if judged := _judged([row for item in found.items for row in item.rows]):
        yield Words((judged,))
    columns = [
        Column("Quantity"), Column("Paper", number=True), Column("Ours", number=True),
        Column("Error", number=True), Column("Mark"),
    ]  # fmt: skip
    for item in found.items:
        if item.rows:
            rows = [
                [Cell(row.number.quantity, note=row.reading), *_values(row), _mark(row)]
                for row in item.rows
            ]
            line = f"{item.title.partition(':')[0]}: {score(item.rows)}"
            yield Fold(line, [Table(f"{item.title}; press a heading to sort", columns, rows)])
    meanings = [f"{kind}: {meaning}" for kind, meaning in MEANINGS.items()]
    yield Fold(
        "What errors, bands and marks mean", [Words((ERRORS,)), Notes(meanings), Words((BANDS,))]
    )


def _judged(rows: Sequence[Row]) -> str:
    """How many numbers that were not fitted have the paper's within their band."""
    told = []
    for kind, words in (
        ("predicted", "predicted numbers"),
        ("undecidable", "undecidable readings"),
    ):
        judged = [row.held for row in rows if row.mark.kind == kind and row.held is not None]
        if judged:
            told.append(f"of {len(judged)} {words} with a band {sum(judged)} hold the paper's")
    return f"{'; '.join(told)}.".capitalize() if told else ""


def _parts(item: Comparison) -> Iterator[Part]:
    if item.key == VEHICLE and item.words:
        yield from item.extras
        yield Words(item.words[:1])
        yield Fold("How it is drawn", [Words(item.words[1:])])
    else:
        yield Words(item.words)
        yield from item.figures
        yield from map(_folded, item.extras)
    if not item.rows:
        if item.failures:
            yield Notes(item.failures)
        return
    columns = [
        Column("Quantity"), Column("Paper", number=True), Column("Ours", number=True),
        Column("Error", number=True), Column("Numerical error", number=True), Column("Mark"),
        Column("Scenario"), Column("Run time", number=True),
    ]  # fmt: skip
    rows = [
        [
            Cell(row.number.quantity, note=_told(row)),
            *_values(row),
            _doubt(row),
            _mark(row, row.mark.basis),
            Cell(row.scenario or "-"),
            quantity(row.wall_time, f"{row.wall_time:.2f} s") if row.scenario and
            math.isfinite(row.wall_time) else Cell("-"),
        ]
        for row in item.rows
    ]  # fmt: skip
    table = Table(f"{item.title}: numbers", columns, rows)
    yield Fold("Numbers, with numerical errors, what marks rest on, and scenarios", [table])
    if item.failures:
        yield Notes(item.failures)


def _told(row: Row) -> str:
    return "; ".join(text for text in (row.reading, f"paper: {row.number.where}") if text)


def _folded(extra: Part) -> Part:
    if isinstance(extra, Table) and len(extra.rows) >= LONG:
        return Fold(f"{extra.title}: {len(extra.rows)} rows", [extra])
    return extra


def _values(row: Row) -> list[Cell]:
    """Paper, ours and the error, sorted by their values; a size counts, not a sign."""
    stated, (paper, ours, error) = row.number, texts(row)
    first = Cell(paper) if isinstance(stated.value, str) else quantity(float(stated.value), paper)
    second = Cell(ours) if isinstance(row.ours, str) else quantity(row.ours / stated.scale, ours)
    if row.agrees is not None:
        tone: Tone = "green" if row.agrees else "red"
        return [first, second, Cell(error, 0.0 if row.agrees else 1.0, tone)]
    third = Cell("")
    if math.isfinite(row.error):
        third = quantity(abs(row.error), error, note=_band(row))
    return [first, second, third]


def _band(row: Row) -> str:
    """The band of our value, and whether it holds the paper's where that was not fitted."""
    if row.mark.band is None:
        return ""
    text = f"band +- {100.0 * row.mark.band:.2g}\N{NO-BREAK SPACE}%"
    if row.held is None:
        return text
    return f"{text}: {'holds' if row.held else 'does not hold'} the paper's"


def _doubt(row: Row) -> Cell:
    """Numerical error in the paper's unit: half step, or spacing of frequencies."""
    if not math.isfinite(row.doubt) or isinstance(row.ours, str):
        return Cell("-")
    unit = "" if row.number.unit == "1" else f"\N{NO-BREAK SPACE}{row.number.unit}"
    return quantity(row.doubt / row.number.scale, f"{row.doubt / row.number.scale:.2g}{unit}")


def _mark(row: Row, note: str = "") -> Cell:
    return Cell(row.mark.kind, tone=TONES[row.mark.kind], note=note)


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "none found"


def _release() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("resilin")
    except PackageNotFoundError:
        return "unknown"


def _digest(figure: Figure) -> str:
    content: Sequence[Any] = [figure.title, figure.data()]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _drawn(path: Path) -> dict[str, str]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return {str(k): str(v) for k, v in found.items()} if isinstance(found, dict) else {}


def _remember(path: Path, known: dict[str, str]) -> None:
    with contextlib.suppress(OutputError), written_whole(path) as waiting:
        waiting.write_text(json.dumps(known, indent=1), encoding="utf-8")
