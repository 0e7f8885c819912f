"""Headings of a file, and the columns that a scenario makes of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import Problems, RecordingError, nearest, printable
from ..units import UnitError, check_unit
from .table import TIME, Column

_WITH_UNIT = re.compile(r"(.*?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]\s*")
_VARIABLE = re.compile(r"[A-Za-z_]\w*(\[\d+(,\d+)*\])?(\.[A-Za-z_]\w*(\[\d+(,\d+)*\])?)*")
CLOCKS = ("time", "t")
LONGEST_HEADING = 1000
"""Characters of a heading in which a unit is looked for."""
EVERY = "*"
"""In place of the name of a component: columns of all, named `component.variable`."""


@dataclass(frozen=True)
class Heading:
    """A column's heading as it is written, and its name and unit: `force.value [N]`, `F (N)`."""

    text: str
    name: str
    unit: str

    @classmethod
    def of(cls, text: str) -> Heading:
        """Heading of one cell; an index, as in `x[1]`, is not a unit."""
        words = text.strip()
        found = _WITH_UNIT.fullmatch(words) if len(words) <= LONGEST_HEADING else None
        if found is None or re.fullmatch(r"[\d, ]*", found[2]):
            return cls(words, words, "")
        return cls(words, found[1], found[2])


@dataclass(frozen=True)
class Choice:
    """A scenario's choice of columns: their component, their variables, their units."""

    component: str = ""
    columns: Mapping[str, str] | None = None
    units: Mapping[str, str] | None = None

    def columns_of(self, path: Path, where: str, headings: list[Heading]) -> list[Column]:
        """The columns in use, time first; `RecordingError` lists all that is wrong with them."""
        if self.component and self.component != EVERY:
            headings = _belonging(path, where, headings, self.component)
        problems = Problems(f"{path}: {where}", RecordingError)
        texts = [h.text for h in headings if h.text]
        for text in sorted({t for t in texts if texts.count(t) > 1}):
            problems.add("headings", f"two columns are named {printable(text)!r}")
        taken = self._mapped(headings, problems) if self.columns else _named(headings)
        if TIME not in taken.values():
            clocks = [k for k, h in enumerate(headings) if h.name.lower() in CLOCKS]
            if clocks:
                taken = {clocks[0]: TIME, **{k: v for k, v in taken.items() if k != clocks[0]}}
        if TIME not in taken.values():
            problems.add(
                "headings",
                f"no column of time; name one {TIME!r} or give one under columns;"
                f" {nearest(TIME, texts)}",
            )
        elif len(taken) < 2:
            problems.add(
                "headings",
                "no column has the name of a variable; name the variables under columns, as"
                f' {{ "F (N)" = "force.value" }}; {nearest("", texts)}',
            )
        made = [self._column(headings[k], k, name, problems) for k, name in taken.items()]
        for key in self.units or {}:
            if not any(key in {c.heading, Heading.of(c.heading).name, c.name} for c in made):
                hint = nearest(key, [c.heading for c in made])
                problems.add("units", f"no column {printable(key)!r}; {hint}")
        problems.check()
        return sorted(made, key=lambda column: column.name != TIME)

    def _mapped(self, headings: list[Heading], problems: Problems) -> dict[int, str]:
        taken: dict[int, str] = {}
        for key, name in (self.columns or {}).items():
            if not _VARIABLE.fullmatch(name):
                problems.add("columns", f"{printable(name)!r} is not the name of a variable")
            found = [k for k, h in enumerate(headings) if h.text == key]
            found = found or [k for k, h in enumerate(headings) if h.name == key]
            if not found:
                hint = nearest(key, [h.text for h in headings if h.text])
                problems.add("columns", f"no column {printable(key)!r}; {hint}")
            elif len(found) > 1:
                problems.add("columns", f"{printable(key)!r} is {len(found)} columns; add the unit")
            elif name in taken.values() or found[0] in taken:
                problems.add(
                    "columns", f"{printable(key)!r} repeats the column or variable of another entry"
                )
            else:
                taken[found[0]] = name
        return taken

    def _column(self, heading: Heading, place: int, name: str, problems: Problems) -> Column:
        """A column with its unit: the file's, else the scenario's."""
        units = self.units or {}
        keys = [key for key in (heading.text, heading.name, name) if key in units]
        given = units[keys[0]] if keys else ""
        where = f"column {printable(heading.text)!r}"
        if heading.unit and given and heading.unit != given:
            problems.add(where, f"is in {printable(heading.unit)}, but under units in {given}")
        unit = heading.unit or given
        try:
            check_unit(unit)
        except UnitError as error:
            problems.add(where, error)
        return Column(place, heading.text, name, unit)


def _named(headings: list[Heading]) -> dict[int, str]:
    """Columns that have the name of a variable."""
    return {k: h.name for k, h in enumerate(headings) if _VARIABLE.fullmatch(h.name)}


def _belonging(path: Path, where: str, headings: list[Heading], component: str) -> list[Heading]:
    """Headings with their names inside a component; those of others are blank."""
    prefix = f"{component}."
    kept = [
        Heading(h.text, h.name.removeprefix(prefix), h.unit)
        if h.name.startswith(prefix) or h.name.lower() in CLOCKS
        else Heading("", "", "")
        for h in headings
    ]
    if not any(h.name.startswith(prefix) for h in headings):
        owners = {h.name.partition(".")[0] for h in headings if "." in h.name}
        raise RecordingError(
            f"{path}: {where}: no column of component {printable(component)!r};"
            f" {nearest(component, owners)}"
        )
    return kept
