"""Recorded series with their units, from an outcome in memory, a result file or a dataset.

Metrics and plots read them from here, so that neither needs the library that labels results.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, RecordingError, printable
from ..scenario.files import is_file
from .outcome import Outcome
from .run_notes import RunNotes, notes_of, read
from .scenario_attribute import scenario_table, settings
from .texts import Change, changes_of

if TYPE_CHECKING:
    import xarray

    from ..recording.binary_process import BinaryFile

Values = NDArray[np.float64]
MOST_PACKED = 1100
"""Bytes of values that one byte of a result stands for at most: deflate packs 1032 into one."""


@dataclass(frozen=True)
class Recorded:
    """Times [s], and series and units by `component.variable`.

    `frequency` [Hz] is that of the drive, 0 without one; `metrics` and `plot` are the scenario's
    own tables; `metric_errors` are estimated, in SI. `texts` holds the changes of what was recorded
    that is no number, and is not among the series. `settings` are those that a file keeps of its
    run.
    """

    times: Values
    series: Mapping[str, Values]
    units: Mapping[str, str]
    title: str = ""
    frequency: float = 0.0
    metrics: Mapping[str, Any] | None = None
    plot: Mapping[str, Any] | None = None
    metric_errors: Mapping[str, float] = field(default_factory=dict)
    texts: Mapping[str, Sequence[Change]] = field(default_factory=dict)
    notes: RunNotes = field(default_factory=RunNotes)
    settings: Mapping[str, str] = field(default_factory=dict)


def recorded(source: Recorded | Outcome | xarray.Dataset) -> Recorded:
    """The recorded series of any of the three; of an outcome the rows that are in memory."""
    if isinstance(source, Recorded):
        return source
    return _of_outcome(source) if isinstance(source, Outcome) else _of_dataset(source)


def _of_outcome(outcome: Outcome) -> Recorded:
    plan = outcome.plan
    names = plan.record_names
    scenario = plan.scenario
    return Recorded(
        times=outcome.times,
        series={name: outcome.rows[:, k] for k, name in enumerate(names)},
        units={
            name: variable.unit for name, (_, variable) in zip(names, plan.records, strict=True)
        },
        title=scenario.title,
        frequency=plan.frequency or 0.0,
        metrics={"cycles": scenario.metrics.cycles, **scenario.metrics.defined},
        plot=dict(scenario.plot),
        metric_errors=outcome.metric_errors,
        texts=outcome.texts,
        notes=notes_of(outcome),
    )


def _of_dataset(data: xarray.Dataset) -> Recorded:
    texts = _listed(data.attrs, "texts")
    times = np.asarray(data["time"].values, dtype=float)
    named = {str(name): str(data[name].attrs.get("original_name", name)) for name in data.data_vars}
    names = {name: own for name, own in named.items() if own not in texts}
    return Recorded(
        times=times,
        series={own: np.asarray(data[name].values) for name, own in names.items()},
        units={own: str(data[name].attrs.get("units", "")) for name, own in names.items()},
        title=str(data.attrs.get("title", "")),
        frequency=float(data.attrs.get("frequency", 0.0)),
        metrics=scenario_table(data.attrs, "metrics"),
        plot=scenario_table(data.attrs, "plot"),
        metric_errors=_metric_errors(data.attrs),
        texts={
            own: changes_of(times, data[name].values) for name, own in named.items() if own in texts
        },
        notes=read(data.attrs),
        settings=settings(data.attrs),
    )


def _listed(attributes: Mapping[str, Any], key: str) -> list[str]:
    """Names that an attribute lists; none of one that cannot be read."""
    try:
        return [str(name) for name in json.loads(attributes.get(key, "[]"))]
    except (TypeError, ValueError):
        return []


def _metric_errors(attributes: Mapping[str, Any]) -> dict[str, float]:
    """Errors of metrics as a file has them; none of one that cannot be read."""
    try:
        found = json.loads(attributes.get("metric_errors", "{}"))
        return {str(name): float(error) for name, error in found.items()}
    except (TypeError, ValueError, AttributeError):
        return {}


def is_sweep(attributes: Mapping[Any, Any]) -> bool:
    """Whether a file with these attributes is the result of a sweep."""
    return "axes" in attributes


def read_recorded(path: Path) -> Recorded:
    """The series of a run's result file, all in memory.

    Raises `InputError` where there is none, where it is not a result of a run, or where a variable
    of it is damaged.
    """
    found = read_run(path)
    if found is None:
        raise InputError(f"{path}: is a sweep; this takes the result of a run")
    return found


def read_run(path: Path) -> Recorded | None:
    """The same, and None of the result of a sweep."""
    with _opened(path) as (file, most):
        return None if is_sweep(file.attributes) else _of_file(path, file, most)


@contextmanager
def _opened(path: Path) -> Iterator[tuple[BinaryFile, int]]:
    """A file in its guarded reader, and how many bytes it may unpack."""
    from ..recording.binary_process import opened

    if not is_file(path):
        raise InputError(
            f"{printable(str(path), most=1000)}: no such result; resilin run makes one"
        )
    most = MOST_PACKED * path.stat().st_size
    try:
        with opened(path, "netCDF", most) as file:
            yield file, most
    except RecordingError as error:
        raise InputError(error.problems) from None


def _of_file(path: Path, file: BinaryFile, most: int) -> Recorded:
    places = {column.name: k for k, column in enumerate(file.columns)}
    rows = file.columns[places["time"]].rows if "time" in places else 0
    if not rows:
        raise InputError(f"{path}: holds no rows over time")
    if len(places) * rows * np.dtype(float).itemsize > most:
        raise InputError(f"{path}: not a result: too small for the {rows} rows that it declares")
    times = file.values(places.pop("time"))
    kept = {name: k for name, k in places.items() if file.columns[k].rows == rows}
    try:
        frequency = float(file.attributes.get("frequency", 0.0))
    except ValueError:
        frequency = 0.0
    texts = _listed(file.attributes, "texts")
    return Recorded(
        times=times,
        series={name: file.values(k) for name, k in kept.items()},
        units={name: file.columns[k].unit for name, k in kept.items()},
        title=file.attributes.get("title", ""),
        frequency=frequency,
        metrics=scenario_table(file.attributes, "metrics"),
        plot=scenario_table(file.attributes, "plot"),
        metric_errors=_metric_errors(file.attributes),
        texts={
            column.name: [(float(times[row]), text) for row, text in file.changes(k)]
            for k, column in enumerate(file.texts)
            if column.name in texts and column.rows == rows
        },
        notes=read(file.attributes),
        settings=settings(file.attributes),
    )
