"""Frequency response of a linearised scenario as a plot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, printable
from ..extras import require
from ..report.image import plain, save_figure, standard_settings
from ..results.netcdf import netcdf_name
from ..results.scenario_attribute import scenario_table
from ..scenario.metric_expression import expression_of
from ..simulation.linear.state_space import Linear

if TYPE_CHECKING:
    import xarray

MOST = 8
"""Outputs that are drawn."""
STYLES = ("-", "--", ":", "-.")
"""Lines of the inputs; an output has one colour."""
LEADING = 91.0
"""Degrees beyond which a phase starts a turn lower: a rate leads by 90, minus one lags by 180."""


@dataclass(frozen=True)
class Curve:
    """The response of one output to one input as it is drawn; what is unknown of it is NaN."""

    output: str
    label: str
    colour: str
    style: str
    response: NDArray[np.complex128]


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
    require("a sweep beside a response", "xarray")
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

    One panel of magnitudes for each unit. What is below the floor of its output is not drawn.
    `frequency` [Hz], where a scenario has one, is marked; `swept` is drawn as points.
    """
    from matplotlib.figure import Figure

    nyquist = 0.5 / system.step
    low = min(0.01 * nyquist, 0.1 * frequency if frequency else np.inf)
    frequencies = np.geomspace(low, 0.5 * nyquist, 400)
    panels = _panels(system, frequencies)
    figure = Figure(figsize=(9.0, 1.0 + 2.4 * (len(panels) + 1)), layout="constrained")
    axes = figure.subplots(len(panels) + 1, 1, sharex=True)
    for axis, (unit, curves) in zip(axes[:-1], panels.items(), strict=True):
        _magnitudes(axis, frequencies, curves, swept)
        axis.set_ylabel(plain(f"magnitude ({unit})"))
    _phases(axes[-1], frequencies, [c for curves in panels.values() for c in curves], swept)
    figure.align_ylabels(axes)
    for axis in axes:
        axis.grid(visible=True, which="both", alpha=0.2)
        if frequency:
            axis.axvline(frequency, color="k", ls=":", lw=0.8)
    if len(system.inputs) == 1:
        figure.suptitle(plain(f"Response to {system.inputs[0]}"), fontsize=10)
    return save_figure(figure, path, 110)


def ratio(output: str, source: str) -> str:
    """The unit of an output over that of an input: m/V, m/(s V), 1/V."""
    if source in {"", "1"}:
        return output or "1"
    over, slash, under = (output or "1").partition("/")
    divisor = f"({source})" if "/" in source else source
    return f"{over}/({under} {divisor})" if slash else f"{over}/{divisor}"


def phase(response: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Degrees without jumps of 360, from a start between -269 and 91; NaN where the response is."""
    known = np.isfinite(response)
    found = np.full(len(response), np.nan)
    found[known] = np.degrees(np.unwrap(np.angle(response[known])))
    return found - 360.0 if known.any() and found[known][0] > LEADING else found


def _panels(system: Linear, frequencies: NDArray[np.float64]) -> dict[str, list[Curve]]:
    """Curves that rise above their floors somewhere, by unit."""
    response = system.response(frequencies)
    panels: dict[str, list[Curve]] = {}
    for row, name in enumerate(system.outputs[:MOST]):
        for column, source in enumerate(system.inputs):
            curve = response[row, column]
            known = np.abs(curve) > system.floor[row]
            if not known.any():
                continue
            label = name if len(system.inputs) == 1 else f"{name}\nfrom {source}"
            unit = ratio(system.units[name], system.units[source])
            panels.setdefault(unit, []).append(
                Curve(name, label, f"C{row}", STYLES[column % 4], np.where(known, curve, np.nan))
            )
    return panels


def _magnitudes(
    axis: Any, frequencies: NDArray[np.float64], curves: list[Curve], swept: Beside | None
) -> None:
    for curve in curves:
        label = "\n".join(plain(line) for line in curve.label.split("\n"))
        axis.loglog(
            frequencies, np.abs(curve.response), curve.style, color=curve.colour, label=label
        )
    for name, colour in {curve.output: curve.colour for curve in curves}.items():
        if swept is not None and (found := swept.amplitudes.get(name)) is not None:
            label = plain(f"{name}, {swept.name}")
            axis.loglog(swept.frequencies, found, "o", ms=3, color=colour, label=label)
    axis.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _phases(
    axis: Any, frequencies: NDArray[np.float64], curves: list[Curve], swept: Beside | None
) -> None:
    from matplotlib.ticker import MaxNLocator

    for curve in curves:
        axis.semilogx(frequencies, phase(curve.response), curve.style, color=curve.colour)
    if swept is not None and swept.lags is not None:
        axis.semilogx(swept.frequencies, -np.degrees(swept.lags), "ko", ms=3)
    axis.set(ylabel="phase (deg)", xlabel="frequency (Hz)")
    axis.yaxis.set_major_locator(MaxNLocator(7, steps=[1.8, 4.5, 9, 10]))
