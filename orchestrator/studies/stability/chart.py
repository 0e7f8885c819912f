"""A stability study as a table, a file for spreadsheets, and heat maps."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import printable
from ...report.image import plain, save_figure, standard_settings
from ..output_files import write_records
from .classification import CLASSES, Trial
from .study import Study

if TYPE_CHECKING:
    from rich.table import Table

COLOURS = {
    "accurate": "#2f7d4f",
    "inaccurate": "#e2b93b",
    "stopped": "#5b7fa6",
    "silent": "#c0392b",
    "late": "#b0b0b0",
    "unjudged": "#8e6bb0",
}
LETTERS = {
    "accurate": "A",
    "inaccurate": "i",
    "stopped": "s",
    "silent": "!",
    "late": ".",
    "unjudged": "?",
}


def table(study: Study) -> Table:
    """A line for each case and method: a letter for each step, coarsest first."""
    from rich.table import Table

    made = Table("case", "master", "steps in a cycle", "", title="stability", title_justify="left")
    for (case, label), trials in _rows(study):
        taken = sorted(t.per_cycle for t in trials if not t.auto)
        steps = f"{taken[0]} ... {taken[-1]}"
        letters = "".join(LETTERS[t.kind] for t in trials if not t.auto)
        letters += "".join(f" {LETTERS[t.kind]}" for t in trials if t.auto)
        made.add_row(printable(case), label, steps, letters)
    return made


def legend() -> str:
    """The meaning of each letter, in one line."""
    return "; ".join(f"{LETTERS[kind]} {kind}: {meaning}" for kind, meaning in CLASSES.items())


def _rows(study: Study) -> list[tuple[tuple[str, str], list[Trial]]]:
    rows: dict[tuple[str, str], list[Trial]] = {}
    for trial in study.trials:
        rows.setdefault((trial.case, f"{trial.master}, {trial.laws}"), []).append(trial)
    return list(rows.items())


def write(study: Study, path: Path) -> Path:
    """Write every trial as a line of CSV; a text that a spreadsheet would compute is quoted."""
    return write_records([asdict(trial) for trial in study.trials], path)


@standard_settings()
def draw(study: Study, path: Path) -> Path:
    """Draw heat maps, one for each method: cases down, steps across, coloured by class."""
    import numpy as np
    from matplotlib import pyplot
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    kinds = list(CLASSES)
    cases = [case.name for case in study.cases]
    steps = sorted({n for case in study.cases for n in case.per_cycle})
    labels = list(dict.fromkeys(f"{t.master}\n{t.laws}" for t in study.trials))
    width, columns = max(5.0, 2.0 + 1.5 * len(labels)), 1 if len(labels) < 5 else 2
    height = 1.3 + 0.22 * len(cases) + 0.16 * len(kinds) / columns
    figure, axes = pyplot.subplots(
        1, len(labels), sharey=True, squeeze=False, figsize=(width, height), layout="constrained"
    )
    for axis, label in zip(axes[0], labels, strict=True):
        field = np.full((len(cases), len(steps)), np.nan)
        for trial in (t for t in study.trials if f"{t.master}\n{t.laws}" == label):
            if trial.per_cycle in steps and not trial.auto:
                place = cases.index(trial.case), steps.index(trial.per_cycle)
                field[place] = kinds.index(trial.kind)
        colours = ListedColormap([COLOURS[kind] for kind in kinds])
        axis.imshow(field, cmap=colours, vmin=-0.5, vmax=len(kinds) - 0.5, aspect="auto")
        axis.set_title(label, fontsize=7)
        axis.set_xticks(range(len(steps)), [str(n) for n in steps], rotation=90, fontsize=6)
        axis.set_yticks(range(len(cases)), [plain(case) for case in cases], fontsize=7)
        axis.set_xlabel("steps in a cycle", fontsize=6)
    handles = [Patch(color=COLOURS[kind], label=f"{kind}: {CLASSES[kind]}") for kind in kinds]
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, fontsize=7)
    try:
        return save_figure(figure, path, 130)
    finally:
        pyplot.close(figure)
