"""A file as a table that can be interpolated: complete, finite, in the order of time."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import RecordingError, printable
from ..units import UnitError, factor
from .binary_files import FORMATS, read_binary, too_large
from .columns import Choice
from .csv_file import PLAIN, read_csv
from .interpolation import Unfit, fitted
from .layout import Layout
from .table import Table, Values

TEXTS = (".csv", ".txt", ".tsv", ".dat", ".asc")
LARGEST = 512 << 20
"""Bytes that a recording may have, packed and unpacked, unless the scenario sets `memory`."""
OVERFLOW = (9.9e37, 9.91e37)
"""What instruments of the SCPI standard write for infinity and for no number."""
ALIKE = 0.01
EVEN = 0.9
LONG = 1.5
"""Where nine steps of ten are alike within a hundredth, one that is longer by half is a gap."""


def read_table(
    path: Path,
    choice: Choice,
    *,
    layout: Layout = PLAIN,
    bridge: str = "",
    most: int = LARGEST,
) -> Table:
    """Checked table of a file: time in seconds and rising, no value missing.

    `layout` is that of a text; `bridge` names the interpolation that fills gaps, without which
    they are refused. Raises :class:`RecordingError` with file, line and remedy.
    """
    suffix = path.suffix.lower()
    if suffix not in TEXTS and suffix not in FORMATS:
        known = ", ".join([*TEXTS, *FORMATS])
        raise RecordingError(f"{path}: no format known for {path.suffix!r}; known are {known}")
    if layout != PLAIN and suffix not in TEXTS:
        fields = Layout.__dataclass_fields__
        given = next(key for key in fields if getattr(layout, key) != getattr(PLAIN, key))
        raise RecordingError(f"{path}: {given}: means nothing to a {suffix} file, only to a text")
    try:
        if path.is_dir():
            raise RecordingError(f"{path}: is a folder, not a recording")
        size = path.stat().st_size
        if size > most:
            raise RecordingError(f"{path}: has {size} bytes, {too_large(most)}")
        if size == 0:
            raise RecordingError(f"{path}: is empty: no headings, no rows")
        if suffix in TEXTS:
            table = read_csv(path, choice, layout)
        else:
            table = read_binary(path, choice, most)
    except OSError as error:
        raise RecordingError(f"{path}: no such recording ({error.strerror or error})") from None
    except csv.Error as error:
        raise RecordingError(f"{path}: is not a table that can be read ({error})") from None
    except ValueError as error:
        raise RecordingError(f"{printable(str(path))}: no such recording ({error})") from None
    if choice.interval:
        rows: Values = np.arange(len(table.times), dtype=float)
        table = replace(table, times=choice.interval * rows)
    return _scaled(_whole(_in_order(_in_seconds(table)), bridge))


def _in_seconds(table: Table) -> Table:
    clock = table.columns[0]
    try:
        scale = factor(clock.unit or "s", "s")
    except UnitError as error:
        raise RecordingError(f"{table.path}: column {clock.heading!r}: {error}") from None
    if (scale, clock.gain, clock.shift) == (1.0, 1.0, 0.0):
        return table
    return replace(table, times=scale * (clock.gain * table.times + clock.shift))


def _scaled(table: Table) -> Table:
    """The values by the gains and shifts of their columns."""
    gains, shifts = np.array([(c.gain, c.shift) for c in table.columns[1:]]).T
    if (gains == 1.0).all() and (shifts == 0.0).all():
        return table
    return replace(table, values=gains * table.values + shifts)


def _in_order(table: Table) -> Table:
    """Two rows or more, their times finite and rising."""
    times = table.times
    if len(times) < 2:
        count = "one row" if len(times) else "no row"
        raise RecordingError(f"{table.path}: {count} under the headings; a recording needs two")
    if not np.isfinite(times).all():
        k = int(np.argmin(np.isfinite(times)))
        raise RecordingError(f"{table.at(k)}: the time is {times[k]}, which is not a finite number")
    with np.errstate(over="ignore"):
        steps = np.diff(times)
    if not (steps > 0.0).all():
        k = int(np.argmax(steps <= 0.0)) + 1
        fault = "is duplicated" if steps[k - 1] == 0.0 else f"comes after {times[k - 1]:.9g} s"
        raise RecordingError(f"{table.at(k)}: t = {times[k]:.9g} s {fault}; times have to rise")
    return table


def _whole(table: Table, bridge: str) -> Table:
    """The table without infinite or missing values; `bridge` fills missing ones in."""
    values = table.values
    over = np.isclose(np.abs(values)[..., None], OVERFLOW, rtol=1e-6, atol=0.0).any(axis=-1)
    if over.any() and not bridge:
        k, j = np.argwhere(over)[0]
        raise RecordingError(
            f"{table.at(k, j)} has {values[k, j]:.4g}, an instrument's mark for"
            ' out of range; leave the rows out, or gaps = "bridge" interpolates'
        )
    if over.any():
        values = np.where(over, np.nan, values)
        table = replace(table, values=values)
    if np.isinf(values).any():
        k, j = np.argwhere(np.isinf(values))[0]
        raise RecordingError(f"{table.at(k, j)} is infinite")
    missing = np.isnan(values)
    if bridge:
        return _bridged(table, bridge, missing) if missing.any() else table
    if missing.any():
        k, j = np.argwhere(missing)[0]
        raise RecordingError(f'{table.at(k, j)} has no value; gaps = "bridge" interpolates')
    steps = np.diff(table.times)
    usual = float(np.median(steps))
    if np.mean(np.abs(steps - usual) < ALIKE * usual) >= EVEN and steps.max() > LONG * usual:
        k = int(np.argmax(steps > LONG * usual)) + 1
        raise RecordingError(
            f"{table.at(k)}: rows are missing, {steps[k - 1]:.4g} s since the row before where"
            f' {usual:.4g} s is usual; gaps = "bridge" interpolates'
        )
    return table


def _bridged(
    table: Table, kind: str, missing: np.ndarray[tuple[int, int], np.dtype[np.bool_]]
) -> Table:
    """Missing values replaced by the interpolation of the others; never at an end."""
    values: Values = table.values.copy()
    for j in range(values.shape[1]):
        holes = missing[:, j]
        if not holes.any():
            continue
        if holes[0] or holes[-1]:
            k = 0 if holes[0] else len(holes) - 1
            raise RecordingError(
                f"{table.at(k, j)} has no value at the end of the recording: nothing to bridge to"
            )
        kept = np.flatnonzero(~holes)
        try:
            known = fitted(table.times[kept], values[kept, j : j + 1], kind)
        except Unfit as error:
            column = None if error.column is None else j
            raise RecordingError(f"{table.at(int(kept[error.row]), column)}: {error}") from None
        values[holes, j] = [known.at(t)[0][0] for t in table.times[holes]]
    return replace(table, values=values)
