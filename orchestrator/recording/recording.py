"""A recording as a scenario uses it: its interface, and its outputs at any time."""

from __future__ import annotations

import functools
import hashlib
from bisect import bisect_right
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import RecordingError, printable
from ..fmi.description import EVENT, Interface, Variable
from ..units import UnitError, factor, si_value
from . import port_law
from .columns import Choice
from .interpolation import Track, Unfit, fitted
from .layout import Layout
from .read import LARGEST, read_table
from .settings import RecordingSettings
from .table import Table, Values

NEVER = 1e30
TOOL = "recording"
FIRST = "first"
LEAST_ROWS = 8
"""Rows of a cycle from which on its first and last steps tell how it goes on."""


@dataclass(frozen=True)
class Recording:
    """Outputs over time.

    `offset` [s] is the run's time less the record's. `sources` gives for each output how it is
    formed, the column of its value, and for curvatures the column of its rate where that is
    recorded too, else -1. `events` are announced discontinuities; `frequency` [Hz] is that of
    the cycle, from the file or from the repetition; `rows` are the times of the file's rows in
    its own clock [s].
    """

    interface: Interface
    track: Track
    offset: float
    before: str
    after: str
    sources: tuple[tuple[str, int, int], ...]
    events: tuple[float, ...]
    frequency: float | None
    rows: Values

    @functools.cached_property
    def curved(self) -> bool:
        """Whether any output is a curvature, which needs means over steps."""
        return any(how in {"curvature", "square"} for how, _, _ in self.sources)

    @property
    def begin(self) -> float:
        """Time of the first row [s], in the run's clock."""
        return self.track.begin + self.offset

    @property
    def end(self) -> float:
        """Time of the last row [s], in the run's clock."""
        return self.track.end + self.offset

    def refusal(self, time: float) -> str:
        """Why the recording has no value at a time; "" where it has one."""
        if self.track.period:
            return ""
        path = self.interface.path
        near = self.track.grain + 1e-12 * abs(time)
        if self.before == "stop" and time < self.begin - near:
            return (
                f"{path} begins only at t = {self.begin:.9g} s; before ="
                ' "hold" or "zero" sets the values before'
            )
        if self.after == "stop" and time > self.end + near:
            return (
                f'{path} ends at t = {self.end:.9g} s; after = "hold" or "zero" sets the'
                " values after, repeat = true starts again with its first row"
            )
        return ""

    def outputs(self, time: float, size: float) -> Values:
        """All outputs at the end of a step of this size [s]; 0 before the first step."""
        inner = time - self.offset
        values, slopes = self.track.at(inner, stepped=size > 0.0)
        made = np.empty(len(self.sources))
        means = (values, values)
        if size > 0.0 and self.curved:
            means = self.track.means(inner, size)
        for k, (how, column, rate) in enumerate(self.sources):
            if how == "column":
                made[k] = values[column]
            elif how == "time":
                made[k] = time
            elif how == "event":
                made[k] = self._next_event(inner) + self.offset
            else:
                y, slope = values[column], slopes[column] if rate < 0 else values[rate]
                if how == "slope":
                    made[k] = slope
                elif size <= 0.0:
                    made[k] = 0.0
                elif how == "curvature":
                    made[k] = 3.0 * (means[0][column] - y + 0.5 * slope * size) / size**2
                else:
                    made[k] = 3.0 * (means[1][column] - y * y + y * slope * size) / size**2
        return made

    def _next_event(self, inner: float) -> float:
        if not self.events:
            return NEVER
        turns = 0.0
        if self.track.period:
            turns = np.floor((inner - self.track.begin + self.track.grain) / self.track.period)
        shift = float(turns) * self.track.period
        k = bisect_right(self.events, inner - shift + self.track.grain)
        if k < len(self.events):
            return self.events[k] + shift
        return self.events[0] + shift + self.track.period if self.track.period else NEVER


def open_recording(component: RecordingSettings, scenario: Path) -> Recording:
    """Recording of a scenario's component, its file from the scenario's folder.

    Raises :class:`RecordingError` with file, place and remedy.
    """
    given = Path(component.data or "")
    path = given if given.is_absolute() else scenario.parent / given
    try:
        stamp = path.stat().st_mtime_ns, path.stat().st_size
    except (OSError, ValueError):
        stamp = 0, 0
    return _opened(
        path, component.model_dump_json(include=set(RecordingSettings.model_fields)), stamp
    )


@functools.lru_cache(maxsize=8)
def _opened(path: Path, settings: str, stamp: tuple[int, int]) -> Recording:
    component = RecordingSettings.model_validate_json(settings)
    most = LARGEST if component.memory is None else _quantity("memory", component.memory, "byte")
    period = 0.0 if isinstance(component.repeat, bool) else _above_zero("repeat", component.repeat)
    bridge = {"band-limited": "cubic"}.get(component.interpolation, component.interpolation)
    bridge = bridge if component.gaps == "bridge" else ""
    choice, layout = _choice(component), _layout(component)
    table = _in_si(read_table(path, choice, layout=layout, bridge=bridge, most=int(most)))
    offset = _offset(component.offset, table)
    span = float(table.times[-1] - table.times[0])
    if component.repeat is True:
        period = span
    if period and period < span * (1.0 - 1e-9):
        raise RecordingError(f"{path}: repeat: {period:g} s is shorter than the record, {span:g} s")
    table, announced = _without_clocks(table)
    try:
        track = fitted(
            times=table.times,
            values=table.values,
            kind=component.interpolation,
            period=period,
            before=component.before,
            after=component.after,
        )
    except Unfit as error:
        raise RecordingError(f"{table.at(error.row, error.column)}: {error}") from None
    events = _events(track, component, announced)
    variables, sources = _variables(table, bool(events))
    interface = Interface(
        path=path,
        version=0,
        model=path.name,
        identifier="",
        guid=_digest(path, settings),
        tool=TOOL,
        variables={variable.name: variable for variable in variables},
        rollback=True,
        variable_step=True,
        once=False,
        needs_tool=False,
        ours=True,
        warnings=_seam_warnings(table) if component.repeat is True else (),
    )
    return Recording(
        interface=interface,
        track=track,
        offset=offset,
        before=component.before,
        after=component.after,
        sources=tuple(sources),
        events=events,
        frequency=_frequency(table) or (1.0 / period if period else None),
        rows=table.times,
    )


def _choice(component: RecordingSettings) -> Choice:
    interval = component.interval
    return Choice(
        component=component.component or "",
        columns=component.columns,
        units=component.units,
        gains=component.gains,
        shifts=component.shifts,
        interval=0.0 if interval is None else _above_zero("interval", interval),
    )


def _layout(component: RecordingSettings) -> Layout:
    return Layout(
        skip=component.skip,
        headings=component.headings,
        units_row=component.units_row,
        names=tuple(component.names),
        encoding=component.encoding,
        decimal=component.decimal,
    )


def _quantity(key: str, value: float | str, unit: str) -> float:
    try:
        return si_value(value, unit)
    except UnitError as error:
        raise RecordingError(f"{key}: {error}") from None


def _above_zero(key: str, value: float | str) -> float:
    period = _quantity(key, value, "s")
    if period <= 0.0:
        raise RecordingError(f"{key}: a time has to be above zero")
    return period


def _offset(value: float | str, table: Table) -> float:
    """Run's time less the record's [s]; "first" lays the first row on the time 0."""
    if value == FIRST:
        return -float(table.times[0])
    return _quantity("offset", value, "s")


def _digest(path: Path, settings: str) -> str:
    digest = hashlib.sha256(settings.encode())
    with path.open("rb") as file:
        while piece := file.read(1 << 20):
            digest.update(piece)
    return digest.hexdigest()[:32]


def _frequency(table: Table) -> float | None:
    """Frequency [Hz] of the run that was recorded, where the file gives it."""
    try:
        value = float(table.comments.get("frequency", "0"))
    except ValueError:
        return None
    return value if 0.0 < value < np.inf else None


def _in_si(table: Table) -> Table:
    """Columns of known members in the units of the ports; others stay as they are."""
    values = table.values.copy()
    columns = table.columns[:1]
    for j, column in enumerate(table.columns[1:]):
        member = column.name.rpartition(".")[2]
        wanted = port_law.SI.get(member, "") if column.unit or member not in port_law.LOOSE else ""
        scale = 1.0
        if wanted and column.unit:
            try:
                scale = factor(column.unit, wanted)
            except UnitError as error:
                if member not in port_law.LOOSE:
                    heading = printable(column.heading)
                    raise RecordingError(f"{table.path}: column {heading!r}: {error}") from None
                wanted = column.unit
        values[:, j] *= scale
        columns = [*columns, replace(column, unit=wanted or column.unit)]
    return replace(table, columns=columns, values=values)


def _without_clocks(table: Table) -> tuple[Table, Values]:
    """The table without the times at which laws hold, and the announced events."""
    names = [column.name.rpartition(".")[2] for column in table.columns[1:]]
    keep = [j for j, name in enumerate(names) if name not in {*port_law.CLOCKS, EVENT}]
    if not keep:
        raise RecordingError(f"{table.path}: columns: times alone are not a recording")
    announced: Values = np.zeros(0)
    for j, column in enumerate(table.columns[1:]):
        if column.name == EVENT:
            announced = np.unique(table.values[:, j])
    columns = [table.columns[0], *(table.columns[j + 1] for j in keep)]
    return replace(table, columns=columns, values=table.values[:, keep]), announced


def _seam_warnings(table: Table) -> tuple[str, ...]:
    """A warning where the first row does not repeat the last one, but goes on from it by a step.

    With the first step a and the last step b of each column the next row would be (a + b)/2 beyond
    the last, to second order in the step. A jump of another size is a discontinuity of the signal.
    """
    times, values = table.times, table.values
    if len(times) < LEAST_ROWS:
        return ()
    size = np.ptp(values, axis=0)
    scaled = values / np.where(size > 0.0, size, 1.0)
    jump = scaled[0] - scaled[-1]
    step = 0.5 * (scaled[1] - scaled[0] + scaled[-1] - scaled[-2])
    if not np.linalg.norm(jump - step) < 0.5 * np.linalg.norm(step):
        return ()
    span, last = float(times[-1] - times[0]), float(times[-1] - times[-2])
    return (
        f"repeat = true takes the last row for the first of the next cycle, but that row is a step"
        f' further on: for a cycle of {span + last:.6g} s write repeat = "{span + last:.9g} s"',
    )


def _events(track: Track, component: RecordingSettings, announced: Values) -> tuple[float, ...]:
    """Times of discontinuities in the record's clock: announced ones, its ends, its seam."""
    begin, end = track.begin, track.end
    inside = announced[(announced > begin) & (announced <= end)].tolist()
    if track.period:
        seam = not np.array_equal(track.last, track.pieces[0, 0])
        return tuple(sorted({*inside, *([end] if seam else [])}))
    ends = [t for t, how in ((begin, component.before), (end, component.after)) if how == "zero"]
    return tuple(sorted({*inside, *ends}))


def _variables(table: Table, eventful: bool) -> tuple[list[Variable], list[tuple[str, int, int]]]:
    """Outputs and the source of each: the columns, and the members derived from them."""
    named = {column.name: j for j, column in enumerate(table.columns[1:])}
    made: list[Variable] = []
    sources: list[tuple[str, int, int]] = []

    def add(name: str, unit: str, meaning: str, source: tuple[str, int, int]) -> None:
        port, _, member = name.rpartition(".")
        if "]" in member:
            port = name.partition("[")[0]
        order = port_law.ORDERS.get(member, 0)
        made.append(_output(len(made), name, unit, meaning, port, order))
        sources.append(source)

    for column in table.columns[1:]:
        add(
            column.name,
            column.unit,
            f"Recorded: {column.heading}",
            ("column", named[column.name], -1),
        )
    ports: dict[str, set[str]] = {}
    for name in named:
        port, _, member = name.rpartition(".")
        ports.setdefault(port, set()).add(member)
    for port, names in ports.items():
        prefix = f"{port}." if port else ""
        if not port:
            continue
        for base, derived in port_law.members(names):
            place = named[prefix + base]
            unit = table.columns[place + 1].unit
            shown = derived.per if derived.how == "time" else f"{unit}{derived.per}" if unit else ""
            rate = named.get(f"{prefix}{'voltage_rate' if derived.how == 'square' else 'rate'}", -1)
            add(prefix + derived.name, shown, derived.meaning, (derived.how, place, rate))
    if eventful:
        add(EVENT, "s", "Time of the next discontinuity of the recording", ("event", -1, -1))
    return made, sources


def _output(reference: int, name: str, unit: str, meaning: str, port: str, order: int) -> Variable:
    return Variable(
        name=name,
        reference=reference,
        kind="Real",
        causality="output",
        unit=unit,
        description=meaning,
        start=None,
        least=None,
        most=None,
        port=port,
        order=order,
        depends=(),
    )
