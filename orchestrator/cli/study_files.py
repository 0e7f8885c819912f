"""Files that a study's command writes: a table, a plot beside it, and a page on demand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer

if TYPE_CHECKING:
    from ..report.page import Page

Study = TypeVar("Study")


@dataclass(frozen=True)
class StudyFiles:
    """A CSV table, an SVG plot of the same name beside it, and a page where one is asked for."""

    table: Path
    page: Path | None = None

    @property
    def plot(self) -> Path:
        """Path of the plot."""
        return self.table.with_suffix(".svg")

    def check(self) -> None:
        """Refuse places where the files cannot be written, before anything runs."""
        from ..report.files import check_place
        from ..report.page import check_page

        for path in (self.table, self.plot):
            check_place(path)
        if self.page is not None:
            check_page(self.page)

    def write(
        self,
        study: Study,
        *,
        table: Callable[[Study, Path], Path],
        plot: Callable[[Study, Path], Path],
        page: Callable[[Study], Page],
    ) -> None:
        """Write a study by the functions of its package."""
        from ..report.page import write

        table(study, self.table)
        plot(study, self.plot)
        if self.page is not None:
            write(page(study), self.page)

    def report(self) -> None:
        """Print where each file is."""
        for label, path in (("table", self.table), ("plot", self.plot), ("page", self.page)):
            if path is not None:
                typer.echo(f"{label + ':':8} {path}")
