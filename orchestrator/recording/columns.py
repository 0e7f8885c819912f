"""Headings of a file, and the columns that a scenario makes of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import Problems, RecordingError, nearest, printable
from ..units import PURE, UnitError, check_unit, factor
from .named_column import in_scenario, on_command_line
from .table import TIME, Column

_WITH_UNIT = re.compile(r"(.*?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]\s*")
_VARIABLE = re.compile(r"[A-Za-z_]\w*(\[\d+(,\d+)*\])?(\.[A-Za-z_]\w*(\[\d+(,\d+)*\])?)*")
CLOCKS = ("time", "t", "timestamp")
SECONDS = ("s", "sec", "secs", "second", "seconds")
"""Spellings of the unit of time whatever their case: a column of time is not in siemens."""
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
        return cls(words, found[1], unit_in(found[2]))


def unit_in(cell: str) -> str:
    """The unit that a cell or a bracket names: `(in mm)` is mm; "" for `-` and `n/a`."""
    found = re.fullmatch(r"[\[(<{]?\s*(?:in\s+)?(.*?)\s*[\])>}]?", cell.strip())
    unit = found[1] if found else ""
    return "" if unit in PURE - {"1"} else unit


@dataclass(frozen=True)
class Choice:
    """A scenario's choice of columns: their component, variables, units, gains and shifts.

    The keys are headings, names without their unit, variables, or places counted from 1. What the
    scenario gives outranks the file. `interval` [s] is the time between rows that have none.
    """

    component: str = ""
    columns: Mapping[str, str] | None = None
    units: Mapping[str, str] | None = None
    gains: Mapping[str, float] | None = None
    shifts: Mapping[str, float] | None = None
    interval: float = 0.0

    @property
    def numbered(self) -> bool:
        """Whether the columns are chosen by their places alone."""
        return bool(self.columns) and all(key.isdecimal() for key in self.columns or {})

    def columns_of(
        self, path: Path, where: str, headings: list[Heading], clocks: tuple[int, ...] = ()
    ) -> list[Column]:
        """The columns in use, time first; `RecordingError` lists all that is wrong with them.

        `clocks` are the places of columns of times of day.
        """
        if self.component and self.component != EVERY:
            headings = _belonging(path, where, headings, self.component)
        problems = Problems(f"{path}: {where}", RecordingError)
        texts = [h.text for h in headings if h.text]
        for text in sorted({t for t in texts if texts.count(t) > 1}) if not self.columns else ():
            problems.add("headings", f"two columns are named {printable(text)!r}")
        taken = self._mapped(headings, problems) if self.columns else _named(headings)
        if TIME not in taken.values() and not self.interval:
            clock = clocks[0] if clocks else _clock(headings)
            if clock is not None:
                taken = {clock: TIME, **{k: v for k, v in taken.items() if k != clock}}
        if self.interval and taken:
            rows = Column(min(taken), "", TIME, "s")
            taken = {k: v for k, v in taken.items() if v != TIME}
        if not self.interval and TIME not in taken.values():
            problems.add(
                "headings",
                f"no column of time; name one {TIME!r} or give one under columns;"
                f" {nearest(TIME, texts)}",
            )
        elif len(taken) < (1 if self.interval else 2):
            others = [text for text in texts if text.lower() not in CLOCKS]
            problems.add(
                "headings",
                "no column has the name of a variable; name the variables, as"
                f" {in_scenario(others, 'force.value')}, on the command line"
                f" {on_command_line(others, 'force.value')}; {nearest('', texts)}",
            )
        for k in clocks:
            headings[k] = Heading(headings[k].text, headings[k].name, "s")
        made = [self._column(headings, k, name, problems) for k, name in taken.items()]
        for table in ("units", "gains", "shifts"):
            for key in getattr(self, table) or {}:
                if not any(key in _keys(headings, c.place, c.name) for c in made):
                    hint = nearest(key, [c.heading for c in made])
                    problems.add(table, f"no column {printable(key)!r}; {hint}")
        problems.check()
        if self.interval:
            return [rows, *made]
        return sorted(made, key=lambda column: column.name != TIME)

    def _mapped(self, headings: list[Heading], problems: Problems) -> dict[int, str]:
        taken: dict[int, str] = {}
        for key, name in (self.columns or {}).items():
            if not _VARIABLE.fullmatch(name):
                problems.add("columns", f"{printable(name)!r} is not the name of a variable")
            found = [k for k, h in enumerate(headings) if h.text == key]
            found = found or [k for k, h in enumerate(headings) if h.name == key]
            if not found and key.isdecimal() and 1 <= int(key) <= len(headings):
                found = [int(key) - 1]
            if not found:
                hint = nearest(key, [h.text for h in headings if h.text])
                problems.add("columns", f"no column {printable(key)!r}; {hint}")
            elif len(found) > 1:
                problems.add(
                    "columns", f"{printable(key)!r} is {len(found)} columns; give its number"
                )
            elif name in taken.values() or found[0] in taken:
                problems.add(
                    "columns", f"{printable(key)!r} repeats the column or variable of another entry"
                )
            else:
                taken[found[0]] = name
        return taken

    def _column(self, headings: list[Heading], place: int, name: str, problems: Problems) -> Column:
        """A column with its unit: the scenario's, else the file's."""
        heading = headings[place]
        keys = _keys(headings, place, name)
        units, gains, shifts = self.units or {}, self.gains or {}, self.shifts or {}
        unit = next((units[key] for key in keys if key in units), heading.unit)
        if name == TIME and unit.lower() in SECONDS:
            unit = "s"
        try:
            check_unit(unit)
        except UnitError as error:
            remedy = f'give its unit, as units = {{ "{printable(heading.name)}" = "V" }}'
            problems.add(f"column {printable(heading.text)!r}", f"{error}; {remedy}")
        gain = next((gains[key] for key in keys if key in gains), 1.0)
        shift = next((shifts[key] for key in keys if key in shifts), 0.0)
        return Column(place, heading.text or str(place + 1), name, unit, gain, shift)


def _keys(headings: list[Heading], place: int, name: str) -> list[str]:
    """What a scenario may call a column; its number where no heading is called so."""
    number = str(place + 1)
    if any(number in (heading.text, heading.name) for heading in headings):
        number = ""
    return [k for k in (headings[place].text, headings[place].name, name, number) if k]


def _clock(headings: list[Heading]) -> int | None:
    """Place of the column of time: the one called so, else the first one if it is in seconds."""
    named = [k for k, h in enumerate(headings) if h.name.lower() in CLOCKS]
    if named:
        return named[0]
    try:
        if headings and headings[0].unit.lower() not in SECONDS:
            factor(headings[0].unit, "s")
        return 0 if headings and headings[0].unit else None
    except UnitError:
        return None


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
