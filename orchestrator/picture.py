"""A picture of a run: what moved, what pushed, what it was fed, over the last cycles."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

PANELS = (
    ("Electrode voltage (kV)", 1e-3, ("voltage",)),
    ("Actuator force (N)", 1.0, ("force.value",)),
    ("Displacement (mm)", 1e3, ("displacement",)),
    ("Flap angle (deg)", 180.0 / np.pi, ("flap_angle",)),
    ("Lift (mN)", 1e3, ("lift",)),
)
CYCLES = 5


def draw(data: xarray.Dataset, path: Path) -> Path:
    """Write a PNG with one panel for each kind of quantity that was recorded."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    names = [str(name) for name in data.data_vars]
    panels = [
        (label, scale, shown)
        for label, scale, endings in PANELS
        if (shown := [n for n in names if n.endswith(tuple(f".{e}" for e in endings))])
    ] or [("value", 1.0, names[:4])]
    time = np.asarray(data["time"].values)
    frequency = float(data.attrs.get("frequency", 0.0))
    keep = time >= time[-1] - CYCLES / frequency if frequency > 0.0 else time >= time[0]
    figure, axes = pyplot.subplots(
        len(panels), 1, sharex=True, figsize=(8.0, 1.0 + 1.6 * len(panels)), squeeze=False
    )
    for axis, (label, scale, shown) in zip(axes[:, 0], panels, strict=True):
        _panel(axis, data, time, keep, label, scale, shown)
    axes[-1, 0].set_xlabel("Time (s)")
    figure.suptitle(str(data.attrs.get("title", "")).replace("$", r"\$"))
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    return path


def _panel(
    axis: Any, data: xarray.Dataset, time: Any, keep: Any, label: str, scale: float, shown: Any
) -> None:
    for name in shown:
        axis.plot(time[keep], scale * np.asarray(data[name].values)[keep], label=name, lw=1.2)
    axis.set_ylabel(label, fontsize=8)
    axis.grid(visible=True, alpha=0.3)
    if len(shown) > 1:
        axis.legend(fontsize=7, loc="upper right")
