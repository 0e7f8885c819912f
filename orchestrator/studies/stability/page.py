"""A stability study as a page: every case by every method, a letter for each step."""

from __future__ import annotations

from collections.abc import Iterator

from ...report.page import Notes, Page, Section
from ...report.table import Cell, Column, Table, Tone
from .chart import LETTERS
from .classification import CLASSES, Trial
from .study import Study

TONES: dict[str, Tone] = {
    "accurate": "green",
    "inaccurate": "amber",
    "stopped": "blue",
    "silent": "red",
    "late": "grey",
    "unjudged": "grey",
}


def page(study: Study) -> Page:
    """Counts, then a table of classes over steps for each use of laws, then what stopped."""
    steps = sorted({trial.per_cycle for trial in study.trials if not trial.auto})
    laws = list(dict.fromkeys(trial.laws for trial in study.trials))
    sections = [
        Section("classes", "Classes", [_counts(study), _meanings()]),
        *(Section(f"laws-{each}", f"Ports: {each}", [_table(study, each, steps)]) for each in laws),
        Section("reasons", "Why runs stopped", [Notes(list(_reasons(study)))]),
        Section("references", "References", [Notes(_references(study))]),
    ]
    facts = [("Cases", str(len(study.cases))), ("Runs", str(len(study.trials))),
             ("Time", f"{study.wall_time:.0f} s"),
             ("Memory of a worker, at most", f"{study.memory / 1e6:.0f} MB")]  # fmt: skip
    lead = "Stiff and extreme cases by every master at a series of steps in a cycle."
    return Page("Stability", lead, sections, facts)


def _references(study: Study) -> list[str]:
    return [f"{case}: {reference}" for case, reference in study.references.items()]


def _counts(study: Study) -> Table:
    counts = [study.count(), study.count("usual"), study.count("auto")]
    titles = ["All runs", "Scenarios' own settings", "Automatic step"]
    columns = [Column("Class"), *(Column(title, number=True) for title in titles)]
    rows = [
        [
            Cell(kind, tone=TONES[kind]),
            *(Cell(str(count[kind]), float(count[kind])) for count in counts),
        ]
        for kind in CLASSES
    ]
    return Table("How many of each", columns, rows)


def _meanings() -> Notes:
    return Notes([f"{LETTERS[kind]} {kind}: {meaning}" for kind, meaning in CLASSES.items()])


def _table(study: Study, laws: str, steps: list[int]) -> Table:
    found: dict[tuple[str, str], dict[int, Trial]] = {}
    for trial in study.trials:
        if trial.laws == laws and not trial.auto:
            found.setdefault((trial.case, trial.master), {})[trial.per_cycle] = trial
    columns = [Column("Case"), Column("Master"), *(Column(f"{n} steps") for n in steps)]
    rows = [
        [Cell(case), Cell(master), *(_cell(trials.get(n)) for n in steps)]
        for (case, master), trials in found.items()
    ]
    return Table(f"Classes over steps in a cycle, ports {laws}", columns, rows)


def _cell(trial: Trial | None) -> Cell:
    if trial is None:
        return Cell("")
    place = float(list(CLASSES).index(trial.kind))
    error = f"{trial.error:.1e}" if trial.error is not None else ""
    return Cell(LETTERS[trial.kind], place, TONES[trial.kind], note=error)


def _reasons(study: Study) -> Iterator[str]:
    """Each reason once, with the first run that stopped for it."""
    first: dict[str, Trial] = {}
    for trial in study.trials:
        if trial.reason:
            first.setdefault(trial.reason, trial)
    for reason, trial in first.items():
        yield f"{trial.case}, {trial.master}, {trial.laws}, {trial.per_cycle} steps: {reason}"
