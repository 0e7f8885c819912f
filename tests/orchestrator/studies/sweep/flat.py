"""Sweeps as they are read from a file, without a scenario behind them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray

FREQUENCY, MASS, WAVEFORM = "amplifier.frequency", "payload.mass", "amplifier.waveform"
UNITS = {FREQUENCY: "Hz", MASS: "kg"}


def flat(
    axes: Mapping[str, Sequence[Any]],
    travel: Callable[..., float],
    *,
    unit: str = "m",
    units: Mapping[str, str] = UNITS,
    **metrics: float,
) -> xarray.Dataset:
    """A sweep whose travel [m] is a function of its place, and other metrics are constant."""
    shape = tuple(map(len, axes.values()))
    places = np.meshgrid(*map(np.array, axes.values()), indexing="ij")
    values = np.array([travel(*place) for place in zip(*(p.ravel() for p in places), strict=True)])
    columns: dict[str, Any] = {
        "travel": (values.reshape(shape), {"units": unit, "shown_in": "mm"}),
        "status": (np.full(shape, "done", dtype=object), {}),
        "steps": (np.full(shape, 100.0), {}),
    } | {name: (np.full(shape, value), {"units": "1"}) for name, value in metrics.items()}
    return xarray.Dataset(
        {name: (list(axes), data, noted) for name, (data, noted) in columns.items()},
        {name: (name, list(axes[name]), {"units": units.get(name, "")}) for name in axes},
        {"axes": "[]", "title": "Flat", "complete": 1},
    )
