"""Recorded series with their units, from an outcome in memory, a result file or a dataset.

Metrics and plots read them from here, so that neither needs the library that labels results.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .outcome import Outcome
from .scenario_attribute import scenario_table

if TYPE_CHECKING:
    import xarray

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Recorded:
    """Times [s], and series and units by `component.variable`.

    `frequency` [Hz] is that of the drive, 0 without one; `metrics` and `plot` are the scenario's
    own tables; `metric_errors` are estimated, in SI.
    """

    times: Values
    series: Mapping[str, Values]
    units: Mapping[str, str]
    title: str = ""
    frequency: float = 0.0
    metrics: Mapping[str, Any] | None = None
    plot: Mapping[str, Any] | None = None
    metric_errors: Mapping[str, float] = field(default_factory=dict)


def recorded(source: Recorded | Outcome | xarray.Dataset) -> Recorded:
    """The recorded series of any of the three; of an outcome the rows that are in memory."""
    if isinstance(source, Recorded):
        return source
    return _of_outcome(source) if isinstance(source, Outcome) else _of_dataset(source)


def _of_outcome(outcome: Outcome) -> Recorded:
    plan = outcome.plan
    names = [f"{component}.{variable.name}" for component, variable in plan.records]
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
    )


def _of_dataset(data: xarray.Dataset) -> Recorded:
    names = {str(name): str(data[name].attrs.get("original_name", name)) for name in data.data_vars}
    return Recorded(
        times=np.asarray(data["time"].values, dtype=float),
        series={own: np.asarray(data[name].values) for name, own in names.items()},
        units={own: str(data[name].attrs.get("units", "")) for name, own in names.items()},
        title=str(data.attrs.get("title", "")),
        frequency=float(data.attrs.get("frequency", 0.0)),
        metrics=scenario_table(data.attrs, "metrics"),
        plot=scenario_table(data.attrs, "plot"),
        metric_errors=_metric_errors(data.attrs),
    )


def _metric_errors(attributes: Mapping[str, Any]) -> dict[str, float]:
    """Errors of metrics as a file has them; none of one that cannot be read."""
    try:
        found = json.loads(attributes.get("metric_errors", "{}"))
        return {str(name): float(error) for name, error in found.items()}
    except (TypeError, ValueError, AttributeError):
        return {}


def read_recorded(path: Path) -> Recorded:
    """The series of a result file, all in memory; `InputError` where it cannot be read."""
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            attributes = {name: file.getncattr(name) for name in file.ncattrs()}
            variables = {
                str(v.getncattr("original_name") if "original_name" in v.ncattrs() else name): v
                for name, v in file.variables.items()
                if name != "time"
            }
            return Recorded(
                times=np.asarray(file["time"][:], dtype=float),
                series={name: np.asarray(v[:], dtype=float) for name, v in variables.items()},
                units={
                    name: str(v.getncattr("units")) if "units" in v.ncattrs() else ""
                    for name, v in variables.items()
                },
                title=str(attributes.get("title", "")),
                frequency=float(attributes.get("frequency", 0.0)),
                metrics=scenario_table(attributes, "metrics"),
                plot=scenario_table(attributes, "plot"),
                metric_errors=_metric_errors(attributes),
            )
    except (OSError, RuntimeError, IndexError, ValueError) as error:
        raise InputError(f"{path}: not a result that can be read ({error})") from None
