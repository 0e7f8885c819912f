"""Frequency response of a linearised scenario as a plot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, printable
from ..report.image import plain, save_figure, standard_settings
from ..results.netcdf import netcdf_name
from ..results.scenario_attribute import scenario_table
from ..scenario.metric_expression import expression_of
from ..simulation.linear.state_space import Linear

if TYPE_CHECKING:
    import xarray

MOST = 8


@dataclass(frozen=True)
class Beside:
    """A sweep of the nonlinear scenario over frequency: half its travels and strokes by the drive.

    Amplitudes are divided by that of the drive, in the unit of the linear input.
    """

    frequencies: NDArray[np.float64]
    amplitudes: dict[str, NDArray[np.float64]]
    lags: NDArray[np.float64] | None
    name: str


def beside(path: Path, drive: float) -> Beside:
    """Read a sweep that `resilin sweep` has written over one parameter called frequency.

    `drive` is the drive's amplitude in the unit of the linear input. Raises `InputError` where the
    file cannot be read as such a sweep.
    """
    import xarray

    try:
        with xarray.open_dataset(path, decode_times=False) as data:
            axes = [str(c) for c in data.coords if str(c).rpartition(".")[2] == "frequency"]
            if len(axes) != 1:
                raise InputError(f"{path}: is not a sweep over one frequency")
            swings, phase = _measured(data)
            found = {
                output: 0.5 * np.asarray(data[metric], float) / drive
                for output, metric in swings.items()
            }
            lags = np.asarray(data[phase], float) if phase else None
            return Beside(np.asarray(data[axes[0]], float), found, lags, path.name)
    except InputError:
        raise
    except Exception as error:  # of the library, or of what it makes of a damaged file
        reason = printable(str(error))
        raise InputError(f"{path}: cannot be read as a sweep ({reason})") from None


def _measured(data: xarray.Dataset) -> tuple[dict[str, str], str]:
    """Metrics of a sweep that are peak to peak values, by their output; and that of a phase."""
    defined = scenario_table(data.attrs, "metrics")
    if not defined:
        raise ValueError("it carries no scenario with metrics")
    swings: dict[str, str] = {}
    phase = ""
    for name, text in defined.items():
        column = netcdf_name(str(name))
        if name == "cycles" or column not in data:
            continue
        expression = expression_of(str(text))
        function = getattr(getattr(expression.tree, "func", None), "id", "")
        if function == "peak_to_peak" and len(expression.variables) == 1:
            swings[expression.variables[0]] = column
        elif function == "phase":
            phase = column
    return swings, phase


@standard_settings()
def draw(
    system: Linear, path: Path, frequency: float | None = None, swept: Beside | None = None
) -> Path:
    """Magnitude and phase from every input to the first outputs, two decades up to Nyquist.

    `frequency` [Hz], where a scenario has one, is marked; `swept` is drawn as points.
    """
    from matplotlib import pyplot

    nyquist = 0.5 / system.step
    low = min(0.01 * nyquist, 0.1 * frequency if frequency else np.inf)
    frequencies = np.geomspace(low, 0.5 * nyquist, 400)
    response = system.response(frequencies)
    figure, axes = pyplot.subplots(2, 1, sharex=True, figsize=(8.0, 6.0))
    for row, name in enumerate(system.outputs[:MOST]):
        for column, source in enumerate(system.inputs):
            curve = response[row, column]
            if not np.any(curve):
                continue
            label = plain(f"{source} to {name}")
            axes[0].loglog(frequencies, np.abs(curve), label=label)
            axes[1].semilogx(frequencies, np.degrees(np.unwrap(np.angle(curve))))
    if swept is not None:
        for name in system.outputs[:MOST]:
            if (found := swept.amplitudes.get(name)) is not None:
                label = plain(f"{name}, {swept.name}")
                axes[0].loglog(swept.frequencies, found, "o", ms=3, label=label)
        if swept.lags is not None:
            axes[1].semilogx(swept.frequencies, -np.degrees(swept.lags), "o", ms=3)
    axes[0].set_ylabel("magnitude (SI)")
    axes[1].set(ylabel="phase (deg)", xlabel="frequency (Hz)")
    for axis in axes:
        axis.grid(visible=True, which="both", alpha=0.2)
        if frequency:
            axis.axvline(frequency, color="k", ls=":", lw=0.8)
    axes[0].legend(fontsize=7)
    figure.set_layout_engine("tight")
    try:
        return save_figure(figure, path, 110)
    finally:
        pyplot.close(figure)
